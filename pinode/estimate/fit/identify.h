// The main job: from a problem to an identified model.

#ifndef PINODE_ESTIMATE_FIT_IDENTIFY_H_
#define PINODE_ESTIMATE_FIT_IDENTIFY_H_

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Solves `problem` by Levenberg-Marquardt in Ceres over multiple shooting
// segments:
//
//   1. signs that nobody said are read off (signs.h); for each start
//      (multistart.h), stages of growing segments
//      (stage_schedule.h, fit.h), beginning from a Rauch-Tung-Striebel smoother
//      on the given model (initial_states.h),
//   2. per stage (stage.h), an augmented Lagrangian closes the gaps
//      (gap_penalty.h); noise levels (noise_levels.h) and weight decay
//      (evidence.h) are re-estimated between its rounds, and networks are
//      learned anew in the last (annealing.h),
//   3. the free run over the whole record is scored (score.h); a stage that
//      makes it worse is undone,
//   4. where the excitation is noisy, its errors become unknowns
//      (input_noise_fit.h),
//   5. covariance (covariance.h), scores and bands of unknown forces
//      (outcome.h, force_bands.h),
//   6. whether all this is usable (usable.h).
//
// `initial`: parameters and noise to start from (nullptr: the problem's own).
// Never throws and never aborts on data: the outcome, good or bad, is in
// *summary and *model; where problem, options or initial are not valid, the
// summary is a failure that says why.
void Identify(const IdentificationProblem& problem,
              const IdentificationOptions& options,
              const IdentifiedModel* initial, IdentificationSummary* summary,
              IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_IDENTIFY_H_
