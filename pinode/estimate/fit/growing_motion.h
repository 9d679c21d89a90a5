// Motions that the matrices of a model let grow by themselves.

#ifndef PINODE_ESTIMATE_FIT_GROWING_MOTION_H_
#define PINODE_ESTIMATE_FIT_GROWING_MOTION_H_

#include "pinode/base/types.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Looks at the matrices of `problem` at `parameters` (all of the problem's). If
// a motion grows by more than limits::kGrowth e-folds over the longest record,
// sets summary->growing_motion to a sentence such as "a motion at 10.98 Hz has
// negative damping in the matrices found", and the advice beside it.
void ReportGrowingMotion(const IdentificationProblem& problem,
                         const Vector& parameters, FitSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_GROWING_MOTION_H_
