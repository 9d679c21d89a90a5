// Weights of the data and of the networks, updated between the rounds of a fit.

#ifndef PINODE_ESTIMATE_FIT_REWEIGHTING_H_
#define PINODE_ESTIMATE_FIT_REWEIGHTING_H_

#include <string>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/base/types.h"
#include "pinode/estimate/fit/fit_log.h"
#include "pinode/estimate/objective/annealing.h"
#include "pinode/estimate/objective/evidence.h"
#include "pinode/estimate/objective/fit_state.h"

namespace pinode {

// Measures the evidence once, and updates decays (evidence.h) and noise levels
// by it. The noise of channels for which it is not given is
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
class Reweighting {
 public:
  // Keeps references to all arguments, which must outlive this object.
  Reweighting(const FitContext& context, FitLog* log, Annealing* annealing)
      : context_(context), log_(log), annealing_(annealing) {}

  // Returns the initial noise levels per training record: given ones, those of
  // `initial` (may be nullptr), or a first guess.
  std::vector<Vector> FirstSigmas(const IdentifiedModel* initial) const;

  struct Outcome {
    bool noise_is_quiet = false;
    // True if neither the noise nor the number of well-determined parameters
    // changes any more.
    bool is_quiet = false;
    // Relative change of the number of well-determined parameters.
    double evidence_change = 0.0;
  };

  // Updates at state->free, and sets the objective's weights too. The noise
  // moves by a limited factor, as far as the annealing allows, and grows only
  // if the fit has `converged`: before, the residuals show the distance still
  // to go. Sets state->share_left. Without a Hessian nothing changes, and the
  // result is quiet only if it was quiet before.
  Outcome Update(bool converged, FitState* state);

 private:
  // Residuals of the fit, per training record: the sums of squares of each
  // channel's residuals in the sensor's unit. With networks also the residuals.
  // If unknown forces need shares per channel, also their derivatives. Both are
  // as in WeightedResiduals (residual_statistics.h).
  struct Rows {
    std::vector<Vector> squares;
    std::vector<Matrix> residuals;
    std::vector<Matrix> jacobians;
  };

  [[nodiscard]] bool MeasureRows(const Vector& free, Rows* rows) const;
  // Moves state->sigmas towards the estimate. Returns the largest relative
  // change wanted.
  double UpdateSigmas(const Rows& rows, const Evidence& evidence,
                      bool converged, FitState* state);
  const SeriesStatistics& Measured(size_t record, int channel) const;
  // Returns the lower limit of the estimates.
  double Smallest(const SeriesStatistics& measured) const;
  double ShareLeft(const Evidence& evidence) const;
  // Returns the share left of one channel of a record, from the leverages of
  // its samples.
  double ChannelShareLeft(size_t record, int channel,
                          const Vector& leverages) const;

  const FitContext& context_;
  FitLog* log_;
  Annealing* annealing_;
  bool noise_is_quiet_ = false;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_REWEIGHTING_H_
