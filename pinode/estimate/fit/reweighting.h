// Between the rounds of a fit: what the data are worth, and what the weights.

#ifndef PINODE_ESTIMATE_FIT_REWEIGHTING_H_
#define PINODE_ESTIMATE_FIT_REWEIGHTING_H_

#include "pinode/estimate/objective/annealing.h"
#include "pinode/estimate/objective/fit_log.h"
#include "pinode/estimate/objective/fit_state.h"
#include "pinode/estimate/objective/noise_levels.h"

namespace pinode {

// Measures the evidence once, and moves decays (evidence.h) and noise levels
// (noise_levels.h) by it.
class Reweighting {
 public:
  // All must outlive this object.
  Reweighting(const FitContext& context, FitLog* log, Annealing* annealing)
      : context_(context), log_(log), noise_(context), annealing_(annealing) {}

  struct Outcome {
    bool noise_is_quiet = false;
    // Neither noise nor the number of well-determined parameters moves any
    // more.
    bool is_quiet = false;
    // Relative change of that number.
    double evidence_change = 0.0;
  };

  // At state->free; sets the objective's weights too. The noise grows only
  // where the fit has `converged`. Where the Hessian cannot be had nothing
  // changes, and nothing is quiet that was not before.
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
