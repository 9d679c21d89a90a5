// One fit: from a problem to a model, without a verdict.

#ifndef PINODE_ESTIMATE_FIT_FIT_ONCE_H_
#define PINODE_ESTIMATE_FIT_FIT_ONCE_H_

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Solves `problem` by Levenberg-Marquardt in Ceres over multiple shooting
// segments. This is the inner step of the main job, which is Identify in
// study/identify/identify.h; call that one.
//
//   1. signs that were not given are found (signs.h); each start
//      (multistart.h) goes through stages of growing segments
//      (stage_schedule.h, fit.h), beginning from a Rauch-Tung-Striebel smoother
//      on the given model (initial_states.h),
//   2. per stage (fit.h), an augmented Lagrangian closes the gaps; noise levels
//      (reweighting.h) and weight decay (evidence.h) are re-estimated between
//      its rounds, and networks are learned anew in the last (annealing.h),
//   3. the free run over the whole record is scored (score.h); a stage that
//      makes it worse is undone,
//   4. where the excitation is noisy, its errors become unknowns
//      (input_noise_fit.h),
//   5. covariance (covariance.h), scores and bands of unknown forces
//      (outcome.h, force_bands.h).
//
// `initial`: parameters and noise to start from. nullptr: the problem's own.
// Never throws and never aborts on data. If problem, options or initial are not
// valid, the summary is a failure that says why.
void FitOnce(const IdentificationProblem& problem,
             const IdentificationOptions& options,
             const IdentifiedModel* initial, FitSummary* summary,
             IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_FIT_ONCE_H_
