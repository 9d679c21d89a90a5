// The main job: from a problem to an identified model.

#ifndef PINODE_ESTIMATE_IDENTIFY_H_
#define PINODE_ESTIMATE_IDENTIFY_H_

#include "pinode/estimate/identification_options.h"
#include "pinode/estimate/identification_problem.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

// Solves `problem` (valid) by Levenberg-Marquardt in Ceres over multiple
// shooting segments, in stages of growing length:
//
//   1. starts from a Rauch-Tung-Striebel smoother on the given model,
//   2. per stage, an augmented Lagrangian closes the gaps, noise levels and
//      weight decay are re-estimated between its rounds,
//   3. the free run over the whole record is scored; a stage that makes it
//      worse is undone,
//   4. where the excitation is noisy, its errors become unknowns,
//   5. covariance and scores.
//
// `initial`: parameters and noise to start from (nullptr: the problem's own).
// Never throws and never aborts on data: the outcome, good or bad, is in
// *summary and *model.
void Identify(const IdentificationProblem& problem,
              const IdentificationOptions& options,
              const IdentifiedModel* initial, IdentificationSummary* summary,
              IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_IDENTIFY_H_
