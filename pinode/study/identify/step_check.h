// Whether the steps with which a fit was integrated are short enough for it.

#ifndef PINODE_STUDY_IDENTIFY_STEP_CHECK_H_
#define PINODE_STUDY_IDENTIFY_STEP_CHECK_H_

#include <string>

#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// How far a fit would move with two steps in place of each: the named parameter
// that would move farthest, in its standard deviations, and by how much in its
// own unit.
struct StepCheck {
  std::string parameter;
  double shift = 0.0;
  double change = 0.0;
  // Whether that is a hundredth of the parameter's value, of 1 for the factors
  // of groups.
  bool is_large = false;

  std::string Sentence() const;
};

// By one Gauss-Newton step from the fit (`summary` and `model` of `problem`):
// what the steps do to the cost's gradient, through its Hessian. Steps are
// chosen for the model before the fit, in which what is unknown may not act
// yet; this sees them where they count. False where no training record takes
// steps, there are networks, whose weights have no standard deviations, or the
// fit has none.
[[nodiscard]] bool CheckStepsAtFit(const IdentificationProblem& problem,
                                   const IdentificationSummary& summary,
                                   const IdentifiedModel& model,
                                   int num_threads, StepCheck* check);

// More exponential steps where they were chosen and the shift is more than a
// tenth of a deviation: as many as make it half of that, by their fourth order.
// False where nothing changes.
bool RefineSteps(const StepCheck& check, IdentificationProblem* problem);

}  // namespace pinode

#endif  // PINODE_STUDY_IDENTIFY_STEP_CHECK_H_
