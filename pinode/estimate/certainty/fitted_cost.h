// The cost around a fit, including unknowns that the fit did not have.

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
  // Linearised cost at the model's parameters, with one segment per record.
  CondensedSystem system;
  // Factor between the number of samples and their effective number, at least
  // 1: the mean autocorrelation time of the residuals. The residuals of a
  // missing term are correlated in time, unless a candidate explains them as
  // well.
  double memory = 1.0;
};

// Sets noise, decays, scales and one segment per record in *objective, a cost
// of `problem`, to the values of a fit. `model` and `scores` as below.
[[nodiscard]] bool PlaceAtFit(const IdentificationProblem& problem,
                              const ParameterLayout& layout,
                              const IdentifiedModel& model,
                              const std::vector<RecordScore>& scores,
                              Objective* objective);

// Linearises the cost of `problem` at a fit. `model`: parameters of `problem`,
// whichever problem they were fitted in, and the noise of each record.
// `scores`: the simulations of that fit, in the problem's order. Returns false
// if they, or the cost, are not finite.
[[nodiscard]] bool LinearizeAtFit(const IdentificationProblem& problem,
                                  const ParameterLayout& layout,
                                  const IdentifiedModel& model,
                                  const std::vector<RecordScore>& scores,
                                  int num_threads, FittedCost* cost);
// Computes the system alone. The memory costs another sweep of the records.
[[nodiscard]] bool LinearizeAtFit(const IdentificationProblem& problem,
                                  const ParameterLayout& layout,
                                  const IdentifiedModel& model,
                                  const std::vector<RecordScore>& scores,
                                  int num_threads, CondensedSystem* system);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_FITTED_COST_H_
