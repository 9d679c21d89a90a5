// Check of the integration steps of a fit.

#ifndef PINODE_STUDY_IDENTIFY_STEP_CHECK_H_
#define PINODE_STUDY_IDENTIFY_STEP_CHECK_H_

#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/verdict.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

// How far a fit would move with two steps in place of each: the named parameter
// that would move farthest, in its standard deviations, and by how much in its
// own unit.
struct StepCheck {
  std::string parameter;
  double shift = 0.0;
  double change = 0.0;
  // The change is a share limits::kStepShare of the parameter's value, of 1 for
  // the factors of groups.
  bool is_large = false;

  // "with two steps in place of each, 'c' would move by ...".
  std::string Sentence() const;
};

// Finds the shift by one Gauss-Newton step from the fit (`summary` and `model`
// of `problem`): halved steps change the cost's gradient, and its Hessian tells
// how far the parameters would follow. Steps are chosen for the initial model,
// in which unknown terms may not act yet; this looks at the fitted one. False
// if no training record takes steps, if there are networks, whose weights have
// no standard deviations, or if the fit has none.
[[nodiscard]] bool CheckStepsAtFit(const IdentificationProblem& problem,
                                   const FitSummary& summary,
                                   const IdentifiedModel& model,
                                   int num_threads, StepCheck* check);

// Takes more steps in records whose steps were chosen, if the shift is more
// than a tenth of a deviation: as many as halve that tenth, by their fourth
// order, and at most eight times as many. Runge-Kutta steps, which make a fit
// dearer, are refined from limits::kNotedStepShift on. False if nothing
// changes.
bool RefineSteps(const StepCheck& check, IdentificationProblem* problem);

struct SettledSteps {
  // Halving the steps of the fit that was given would have moved a parameter by
  // more than limits::kNotedStepShift.
  bool were_long = false;
  bool refined = false;
  std::vector<Finding> findings;
};

// Checks the steps of a fit of *problem. Where finer ones would move what was
// found, refines them (at most twice) and goes on with the fit. A shift that is
// left becomes a finding where limits::kStepShift forbids it, else a remark of
// *summary.
SettledSteps SettleSteps(const IdentificationOptions& options, InnerFit* fit,
                         IdentificationProblem* problem, FitSummary* summary,
                         IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_STUDY_IDENTIFY_STEP_CHECK_H_
