// Standard deviations of the channels' noise.

#ifndef PINODE_ESTIMATE_OBJECTIVE_NOISE_LEVELS_H_
#define PINODE_ESTIMATE_OBJECTIVE_NOISE_LEVELS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/annealing.h"
#include "pinode/estimate/objective/evidence.h"
#include "pinode/estimate/objective/fit_state.h"

namespace pinode {

// Checks given noise: one positive number per channel and training record, or
// nothing at all. Returns false, with *error, for anything else.
[[nodiscard]] bool AreValidSigmas(const IdentificationProblem& problem,
                                  const std::vector<Vector>& sigmas,
                                  std::string* error);

// Residuals of a fit, per training record: the sums of squares of each
// channel's residuals in the sensor's unit. With networks also the residuals.
// If unknown forces need shares per channel, also their derivatives. Both are
// as in MultipleShooting::WeightedResiduals.
struct WeightedRows {
  std::vector<Vector> squares;
  std::vector<Matrix> residuals;
  std::vector<Matrix> jacobians;
};

// Estimates the noise of channels for which it is not given, between the rounds
// of a fit,
//
//   sigma^2 = (mean square of the channel's residuals) / (share left),
//
// where the share left is what remains after the fit has used up its part. With
// the effective parameters of the evidence,
//
//   share left = 1 - (effective - modes' part + free starts) / samples
//
// for all channels together. If an unknown force can follow a single channel's
// noise, it is 1 - (the channel's leverages) / (its samples). With networks a
// mean square is multiplied by the autocorrelation time of the residuals,
// because these are correlated misfit.
class NoiseLevels {
 public:
  // Keeps a reference to `context`, which must outlive this object.
  explicit NoiseLevels(const FitContext& context) : context_(context) {}

  // Returns the initial levels per training record: given ones, those of
  // `initial` (may be nullptr), or a first guess.
  std::vector<Vector> First(const IdentifiedModel* initial) const;

  // Difference between a round's estimate and the levels so far.
  struct Change {
    // Largest relative change wanted.
    double wanted = 0.0;
    bool quiet = false;
    // The first channel whose noise an unknown force follows; empty: none.
    std::string followed_record, followed_channel;
  };

  // Moves state->sigmas towards the estimate from `rows`, limited by
  // `annealing` if that is on, and sets state->share_left. `converged`: before
  // convergence the residuals show the distance still to go, and noise does not
  // grow with networks.
  Change Update(const WeightedRows& rows, const Evidence& evidence,
                bool converged, Annealing* annealing, FitState* state) const;

 private:
  const SeriesStatistics& Measured(size_t record, int channel) const;
  // Returns the lower limit of the estimates.
  double Smallest(const SeriesStatistics& measured) const;
  double ShareLeft(const Evidence& evidence) const;
  // Returns the share left of one channel of a record, from the leverages of
  // its samples; *change notes the channel if a force follows its noise.
  double ChannelShareLeft(size_t record, int channel, const Vector& leverages,
                          Change* change) const;

  const FitContext& context_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_NOISE_LEVELS_H_
