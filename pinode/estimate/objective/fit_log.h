// The writer of a fit's summary.

#ifndef PINODE_ESTIMATE_OBJECTIVE_FIT_LOG_H_
#define PINODE_ESTIMATE_OBJECTIVE_FIT_LOG_H_

#include <string>
#include <utility>

#include "pinode/problem/fit_summary.h"

namespace pinode {

// Writes what happens during a fit into its summary. A part of the fit that
// writes receives a pointer to the log; all others read the summary in the
// FitContext.
class FitLog {
 public:
  // `summary` must outlive this object.
  explicit FitLog(FitSummary* summary) : summary_(*summary) {}

  // Reason why the fit cannot go on.
  void SetMessage(std::string message) {
    summary_.message = std::move(message);
  }

  // Iteration `number` of the fit has ended.
  void AddIteration(int number, bool accepted) {
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
  FitSummary& summary_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_FIT_LOG_H_
