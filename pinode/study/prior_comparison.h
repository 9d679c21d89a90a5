// The model before an identification, beside the one that it found.

#ifndef PINODE_STUDY_PRIOR_COMPARISON_H_
#define PINODE_STUDY_PRIOR_COMPARISON_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/identification_problem.h"
#include "pinode/estimate/identification_summary.h"
#include "pinode/structure/mode_comparison.h"

namespace pinode {

struct PriorComparison {
  // By record: the free run of the model before, channels x samples; empty
  // where it is not finite.
  std::vector<Matrix> predictions;
  // Modes of the matrices with their groups, before and after, in cycles per
  // unit of the model's time.
  std::vector<ModePair> modes;
  // Why there are no modes; empty where there are.
  std::string why_no_modes;
};

// Of the records that `summary` scores, and of `model` where it has a value per
// parameter. Nothing is compared of a problem that is not valid.
PriorComparison CompareWithPrior(const IdentificationProblem& problem,
                                 const IdentificationSummary& summary,
                                 const IdentifiedModel& model);

}  // namespace pinode

#endif  // PINODE_STUDY_PRIOR_COMPARISON_H_
