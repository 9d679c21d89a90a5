// One start's way through all stages.

#ifndef PINODE_ESTIMATE_FIT_FIT_H_
#define PINODE_ESTIMATE_FIT_FIT_H_

#include <optional>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/certainty/input_noise_fit.h"
#include "pinode/estimate/fit/reweighting.h"
#include "pinode/estimate/fit/solve.h"
#include "pinode/estimate/fit/stage.h"
#include "pinode/estimate/objective/annealing.h"
#include "pinode/estimate/objective/fit_log.h"
#include "pinode/estimate/objective/fit_state.h"
#include "pinode/problem/progress.h"

namespace pinode {

// Goes through the stages of stage_schedule.h, each a Stage, and keeps what
// predicts best: a stage that makes the error to be expected worse is undone.
// Networks are annealed in the last one (annealing.h); after it errors of the
// excitation become unknowns where they can (input_noise_fit.h).
class Fit {
 public:
  // `problem` must outlive this object.
  Fit(const IdentificationProblem& problem,
      const IdentificationOptions& options);
  Fit(const Fit&) = delete;
  Fit& operator=(const Fit&) = delete;

  // Runs all stages from the values given, all of the problem's; noise and
  // decays from `initial` (may be nullptr), which says too where a fit that was
  // cut off goes on. False, with the summary's message, where nothing finite
  // came out.
  [[nodiscard]] bool Run(const Vector& parameters,
                         const IdentifiedModel* initial);

  // Iterations, stages and counts; the outcome is somebody else's to report.
  const FitSummary& summary() const { return summary_; }
  const FitState& best() const { return best_; }
  // The stage in which it ended, from 1.
  int stage() const { return stage_; }
  bool converged() const { return converged_; }
  bool interrupted() const { return progress_.interrupted(); }
  // Set where the fit ended with the excitation's errors as unknowns.
  const std::optional<InputNoiseFit>& input_noise() const {
    return input_noise_;
  }
  const ParameterLayout& layout() const { return layout_; }
  Objective& objective() { return objective_; }
  const MultipleShooting::Options& shooting_options() const {
    return shooting_options_;
  }
  // All parameters with the free ones as in best().
  Vector BestParameters() const;

 private:
  // What a fit goes on with, without starts: these values, or, while annealed
  // networks have not caught up, what the stages before have found.
  IdentifiedModel ModelToKeep(const Vector& free);
  // Below the misfit that networks are allowed, the simpler one counts as the
  // better.
  bool IsWorseThanBest(const FitState& state) const;
  // Noise, decays and trajectories before the first stage.
  [[nodiscard]] bool Prepare(const Vector& parameters,
                             Eigen::Index segment_samples,
                             const IdentifiedModel* initial);
  [[nodiscard]] bool RunStage(Eigen::Index samples, bool last);
  void BeginAnnealing();
  void FitInputNoise();

  const IdentificationOptions options_;
  FitSummary summary_;
  FitLog log_;  // writes summary_
  const ParameterLayout layout_;
  const MultipleShooting::Options shooting_options_;
  Objective objective_;
  const FitContext context_;
  Progress progress_;
  Solver solver_;
  Annealing annealing_;
  Reweighting reweighting_;

  Vector first_free_;  // as the run began
  FitState current_;
  FitState best_;
  std::optional<InputNoiseFit> input_noise_;
  bool converged_ = false;
  int stage_ = 0;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_FIT_H_
