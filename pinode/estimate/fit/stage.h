// One stage of a fit: segments of one length.

#ifndef PINODE_ESTIMATE_FIT_STAGE_H_
#define PINODE_ESTIMATE_FIT_STAGE_H_

#include "pinode/estimate/fit/reweighting.h"
#include "pinode/estimate/fit/solve.h"
#include "pinode/estimate/objective/fit_log.h"
#include "pinode/estimate/objective/fit_state.h"
#include "pinode/problem/progress.h"

namespace pinode {

// Solves in rounds, between which noise levels and decays are re-estimated:
//
//   several segments   an augmented Lagrangian (gap_penalty.h) closes the gaps
//   single segments    until noise and evidence are quiet, then to the
//                      tolerance that the user asked for
class Stage {
 public:
  // All must outlive this object.
  Stage(const FitContext& context, FitLog* log, Solver* solver,
        Reweighting* reweighting, Progress* progress)
      : context_(context),
        log_(log),
        solver_(solver),
        reweighting_(reweighting),
        progress_(progress) {}

  // From and to *state, with segments of about `samples` samples; 0: one a
  // record. *settled: it has converged, and what is between its rounds with it.
  // Fills *record but for whether it is rolled back. False, with the summary's
  // message, where no finite trajectory leaves from here.
  [[nodiscard]] bool Run(Eigen::Index samples, bool last, FitState* state,
                         StageRecord* record, bool* settled);

 private:
  [[nodiscard]] bool CloseGaps(bool last, FitState* state, bool* settled);
  [[nodiscard]] bool SettleSingle(FitState* state, bool* settled);

  const FitContext& context_;
  FitLog* log_;
  Solver* solver_;
  Reweighting* reweighting_;
  Progress* progress_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_STAGE_H_
