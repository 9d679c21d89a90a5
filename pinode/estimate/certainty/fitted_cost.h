// The cost around a fit, with unknowns that the fit did not have.

#ifndef PINODE_ESTIMATE_CERTAINTY_FITTED_COST_H_
#define PINODE_ESTIMATE_CERTAINTY_FITTED_COST_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

struct FittedCost {
  // At the model's parameters, in one segment a record.
  CondensedSystem system;
  // By how much the samples are fewer than they look, at least 1: the mean
  // autocorrelation time of the residuals. What a lacking term leaves over has
  // a memory, and what no candidate explains as well.
  double memory = 1.0;
};

// Sets noise, decays, scales and one segment a record in *objective, a cost of
// `problem`, to what a fit has come to. `model` and `scores` as below.
[[nodiscard]] bool PlaceAtFit(const IdentificationProblem& problem,
                              const ParameterLayout& layout,
                              const IdentifiedModel& model,
                              const std::vector<RecordScore>& scores,
                              Objective* objective);

// `model`: parameters of `problem`, whatever they were fitted in, and the noise
// of each record. `scores`: the free runs of that fit, in the problem's order.
// False where they, or the cost, are not finite.
[[nodiscard]] bool LinearizeAtFit(const IdentificationProblem& problem,
                                  const ParameterLayout& layout,
                                  const IdentifiedModel& model,
                                  const std::vector<RecordScore>& scores,
                                  int num_threads, FittedCost* cost);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_FITTED_COST_H_
