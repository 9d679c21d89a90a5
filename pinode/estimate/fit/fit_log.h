// The writer of a fit's summary, which also tells the caller of its progress.

#ifndef PINODE_ESTIMATE_FIT_FIT_LOG_H_
#define PINODE_ESTIMATE_FIT_FIT_LOG_H_

#include <chrono>
#include <functional>
#include <string>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Writes what happens during a fit into its summary, and asks the caller after
// each iteration whether to continue. A part of the fit that writes receives a
// pointer to the log; all others read the summary in the FitContext.
class FitLog {
 public:
  // Returns the model that the fit would keep at these free parameters. Called
  // only if there is a callback to inform.
  using ModelToKeep = std::function<IdentifiedModel(const Vector& free)>;

  // Keeps references to `options` and `summary`, which must outlive this
  // object.
  FitLog(const IdentificationOptions& options, ModelToKeep model_to_keep,
         FitSummary* summary);

  // Reason why the fit cannot go on.
  void SetMessage(std::string message) {
    summary_.message = std::move(message);
  }

  void BeginStage(int stage, int num_stages, Eigen::Index segment_samples);
  // The newest error measured of a simulation of the training records.
  void SetFreeRunError(double error) { free_run_error_ = error; }

  // Records an iteration (its number, cost, norms and radius filled in) and
  // calls GoOn.
  bool Note(IterationRecord iteration, const Vector& free);
  // Reports the state of the fit to the caller; false if the fit is to stop.
  bool GoOn(const Vector& free, double cost, double largest_gap);
  // True if the caller stopped the fit.
  bool interrupted() const { return interrupted_; }

  // Iteration `number` of the fit has ended.
  void CountIteration(int number, bool accepted) {
    summary_.num_iterations = number;
    if (!accepted) ++summary_.rejected_steps;
  }
  void AddJacobianSeconds(double seconds) {
    summary_.jacobian_seconds += seconds;
  }
  void AddLinearSolverSeconds(double seconds) {
    summary_.linear_solver_seconds += seconds;
  }
  void AddFailedEvaluations(int count) { summary_.failed_evaluations += count; }

  // Number of well-determined parameters.
  void SetEffectiveParameters(double effective) {
    summary_.effective_parameters = effective;
  }
  // The channel whose noise a force follows; empty: none.
  void SetFollowedChannel(const std::string& record,
                          const std::string& channel) {
    summary_.followed_record = record;
    summary_.followed_channel = channel;
  }

  // Gaps and segments at the end of a stage.
  void SetSegments(double largest_gap, bool single_shooting) {
    summary_.largest_gap = largest_gap;
    summary_.single_shooting = single_shooting;
  }
  void AddStage(const StageRecord& stage) { summary_.stages.push_back(stage); }

 private:
  const IdentificationOptions& options_;
  const ModelToKeep model_to_keep_;
  FitSummary& summary_;
  std::chrono::steady_clock::time_point begin_;
  int stage_ = 0;
  int num_stages_ = 0;
  Eigen::Index segment_samples_ = 0;
  double free_run_error_ = kInfinity;
  bool interrupted_ = false;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_FIT_LOG_H_
