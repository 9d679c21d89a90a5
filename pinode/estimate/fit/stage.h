// One stage of a fit, with segments of one length.

#ifndef PINODE_ESTIMATE_FIT_STAGE_H_
#define PINODE_ESTIMATE_FIT_STAGE_H_

#include "pinode/estimate/fit/fit_log.h"
#include "pinode/estimate/fit/reweighting.h"
#include "pinode/estimate/fit/solve.h"
#include "pinode/estimate/objective/fit_state.h"

namespace pinode {

// Solves in rounds. Noise levels and decays are estimated again between them:
//
//   several segments   an augmented Lagrangian (gap_penalty.h) closes the gaps
//   single segments    until noise and evidence are quiet, then to the
//                      tolerance that the user asked for
class Stage {
 public:
  // Keeps references to all arguments, which must outlive this object.
  Stage(const FitContext& context, FitLog* log, Solver* solver,
        Reweighting* reweighting)
      : context_(context),
        log_(log),
        solver_(solver),
        reweighting_(reweighting) {}

  // Updates *state with segments of about `samples` samples; 0: one per record.
  // *settled: the solve has converged, and so have noise and decays. Fills
  // *record, except for its flag of a rollback. Returns false, with the
  // summary's message, if no finite trajectory starts from here.
  [[nodiscard]] bool Run(Eigen::Index samples, bool last, FitState* state,
                         StageRecord* record, bool* settled);

 private:
  [[nodiscard]] bool CloseGaps(bool last, FitState* state, bool* settled);
  [[nodiscard]] bool SettleSingle(FitState* state, bool* settled);

  const FitContext& context_;
  FitLog* log_;
  Solver* solver_;
  Reweighting* reweighting_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_STAGE_H_
