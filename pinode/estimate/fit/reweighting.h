// Weights of the data and of the networks, updated between the rounds of a fit.

#ifndef PINODE_ESTIMATE_FIT_REWEIGHTING_H_
#define PINODE_ESTIMATE_FIT_REWEIGHTING_H_

#include "pinode/estimate/fit/fit_log.h"
#include "pinode/estimate/objective/annealing.h"
#include "pinode/estimate/objective/fit_state.h"
#include "pinode/estimate/objective/noise_levels.h"

namespace pinode {

// Measures the evidence once, and updates decays (evidence.h) and noise levels
// (noise_levels.h) by it.
class Reweighting {
 public:
  // Keeps references to all arguments, which must outlive this object.
  Reweighting(const FitContext& context, FitLog* log, Annealing* annealing)
      : context_(context), log_(log), noise_(context), annealing_(annealing) {}

  struct Outcome {
    bool noise_is_quiet = false;
    // True if neither the noise nor the number of well-determined parameters
    // changes any more.
    bool is_quiet = false;
    // Relative change of the number of well-determined parameters.
    double evidence_change = 0.0;
  };

  // Updates at state->free, and sets the objective's weights too. The noise
  // grows only if the fit has `converged`. Without a Hessian nothing changes,
  // and the result is quiet only if it was quiet before.
  Outcome Update(bool converged, FitState* state);

  const NoiseLevels& noise() const { return noise_; }

 private:
  const FitContext& context_;
  FitLog* log_;
  NoiseLevels noise_;
  Annealing* annealing_;
  bool noise_is_quiet_ = false;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_REWEIGHTING_H_
