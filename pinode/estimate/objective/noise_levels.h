// The standard deviations of the channels' noise.

#ifndef PINODE_ESTIMATE_OBJECTIVE_NOISE_LEVELS_H_
#define PINODE_ESTIMATE_OBJECTIVE_NOISE_LEVELS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/annealing.h"
#include "pinode/estimate/objective/evidence.h"
#include "pinode/estimate/objective/fit_state.h"

namespace pinode {

// Checks the noise that a caller gives: one positive number per channel and
// training record, or nothing at all. False, with *error, for anything else.
[[nodiscard]] bool AreValidSigmas(const IdentificationProblem& problem,
                                  const std::vector<Vector>& sigmas,
                                  std::string* error);

// What a fit leaves over, per training record: the sums of squares of each
// channel's residuals in the sensor's unit; with networks also the residuals,
// and where unknown forces make it count channel by channel their derivatives,
// as MultipleShooting::WeightedResiduals has both.
struct WeightedRows {
  std::vector<Vector> squares;
  std::vector<Matrix> residuals;
  std::vector<Matrix> jacobians;
};

// Estimates the noise of channels for which none is given, between the rounds
// of a fit,
//
//   sigma^2 = (mean square of the channel's residuals) / (share left),
//
// where the share left allows for what the fit has used up: with the effective
// parameters of the evidence
//
//   share left = 1 - (effective - modes' part + free starts) / samples
//
// for all channels together, or, where an unknown force can follow a single
// channel's noise, 1 - (the channel's leverages) / (its samples). With networks
// a mean square counts as many times as the residuals' autocorrelation time is
// long: what they leave over is misfit with a memory.
class NoiseLevels {
 public:
  // `context` must outlive this object.
  explicit NoiseLevels(const FitContext& context) : context_(context) {}

  // Per training record: given ones, those of `initial` (may be nullptr), or a
  // first guess.
  std::vector<Vector> First(const IdentifiedModel* initial) const;

  // How far a round's estimate is from the levels so far.
  struct Change {
    // Largest relative change wanted.
    double wanted = 0.0;
    bool quiet = false;
    // The first channel whose noise an unknown force follows; empty: none.
    std::string followed_record, followed_channel;
  };

  // Moves state->sigmas towards the estimate from `rows`, limited by
  // `annealing` where that is on, and sets state->share_left. `converged`:
  // before, the residuals tell of the way that is left, and noise does not grow
  // with networks.
  Change Update(const WeightedRows& rows, const Evidence& evidence,
                bool converged, Annealing* annealing, FitState* state) const;

 private:
  const SeriesStatistics& Measured(size_t record, int channel) const;
  // No estimate goes below.
  double Smallest(const SeriesStatistics& measured) const;
  double ShareLeft(const Evidence& evidence) const;
  // Share left of one channel of a record, from the leverages of its samples;
  // *change notes the channel if a force follows its noise.
  double ChannelShareLeft(size_t record, int channel, const Vector& leverages,
                          Change* change) const;

  const FitContext& context_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_NOISE_LEVELS_H_
