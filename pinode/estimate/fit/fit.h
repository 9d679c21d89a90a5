// Fit from one start through all stages.

#ifndef PINODE_ESTIMATE_FIT_FIT_H_
#define PINODE_ESTIMATE_FIT_FIT_H_

#include <optional>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/certainty/input_noise_fit.h"
#include "pinode/estimate/fit/fit_log.h"
#include "pinode/estimate/fit/reweighting.h"
#include "pinode/estimate/fit/solve.h"
#include "pinode/estimate/objective/annealing.h"
#include "pinode/estimate/objective/fit_state.h"

namespace pinode {

// Runs the stages of stage_schedule.h, each with segments of one length, and
// keeps the state with the best prediction. A stage solves in rounds. Noise
// levels and decays are estimated again between them (reweighting.h):
//
//   several segments   an augmented Lagrangian (gap_penalty.h) closes the gaps
//   single segments    until noise and evidence are quiet, then to the
//                      tolerance that the user asked for
//
// A stage that increases the expected error is undone. Networks are annealed in
// the last stage (annealing.h). After it, errors of the excitation become
// unknowns if possible (input_noise_fit.h).
class Fit {
 public:
  // Keeps a reference to `problem`, which must outlive this object.
  Fit(const IdentificationProblem& problem,
      const IdentificationOptions& options);
  Fit(const Fit&) = delete;
  Fit& operator=(const Fit&) = delete;

  // Runs all stages from `parameters`, all of the problem's. Noise and decays
  // come from `initial` (may be nullptr), which also says where an interrupted
  // fit continues. Returns false, with the summary's message, if there is no
  // finite result.
  [[nodiscard]] bool Run(const Vector& parameters,
                         const IdentifiedModel* initial);

  // Iterations, stages and counts; the results are reported by others.
  const FitSummary& summary() const { return summary_; }
  const FitState& best() const { return best_; }
  // Stage in which the fit ended, from 1.
  int stage() const { return stage_; }
  bool converged() const { return converged_; }
  bool interrupted() const { return log_.interrupted(); }
  // Set if the fit ended with the excitation's errors as unknowns.
  const std::optional<InputNoiseFit>& input_noise() const {
    return input_noise_;
  }
  const ParameterLayout& layout() const { return layout_; }
  Objective& objective() { return objective_; }
  const MultipleShooting::Options& shooting_options() const {
    return shooting_options_;
  }
  // Returns all parameters, with the free ones as in best().
  Vector BestParameters() const;

 private:
  // Returns the model with which a fit can continue, without starts. It has
  // these values or, while annealed networks have not caught up, those of the
  // stages before.
  IdentifiedModel ModelToKeep(const Vector& free);
  // Compares the expected errors. Below the misfit allowed for networks, the
  // simpler state is the better one.
  bool IsWorseThanBest(const FitState& state) const;
  // Returns the starts of the training records in `initial`. Empty if it lacks
  // one, or if the structure is linear: its starts have one minimum only.
  std::vector<Vector> KnownStarts(const IdentifiedModel* initial) const;
  // Sets noise, decays and trajectories before the first stage.
  [[nodiscard]] bool Prepare(const Vector& parameters,
                             Eigen::Index segment_samples,
                             const IdentifiedModel* initial);
  // Runs a stage with segments of about `samples` samples; 0: one per record.
  // Keeps its state, or undoes it. Returns false, with the summary's message,
  // if no finite trajectory starts from here.
  [[nodiscard]] bool RunStage(Eigen::Index samples, bool last);
  // The solve of a stage, without a judgement of its state. *settled: the solve
  // has converged, and so have noise and decays. Fills *record, except for its
  // flag of a rollback.
  [[nodiscard]] bool SolveStage(Eigen::Index samples, bool last,
                                StageRecord* record, bool* settled);
  // Cuts the records along the current trajectories, and linearises there.
  [[nodiscard]] bool BeginSegments(Eigen::Index samples, StageRecord* record);
  [[nodiscard]] bool CloseGaps(bool last, bool* settled);
  [[nodiscard]] bool SettleSingle(bool* settled);
  // Returns the error of simulations at `free`, which progress shows from now
  // on.
  double MeasureFreeRun(const Vector& free);
  void BeginAnnealing();
  void FitInputNoise();

  const IdentificationOptions options_;
  FitSummary summary_;
  FitLog log_;  // writes summary_
  const ParameterLayout layout_;
  const MultipleShooting::Options shooting_options_;
  Objective objective_;
  const FitContext context_;
  Solver solver_;
  Annealing annealing_;
  Reweighting reweighting_;

  Vector first_free_;  // at the beginning of the run
  FitState current_;
  FitState best_;
  std::optional<InputNoiseFit> input_noise_;
  bool converged_ = false;
  int stage_ = 0;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_FIT_H_
