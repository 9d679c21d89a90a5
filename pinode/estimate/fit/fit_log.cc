#include "pinode/estimate/fit/fit_log.h"

#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/stopwatch.h"

namespace pinode {

FitLog::FitLog(const IdentificationOptions& options, ModelToKeep model_to_keep,
               FitSummary* summary)
    : options_(options),
      model_to_keep_(std::move(model_to_keep)),
      summary_(*summary),
      begin_(std::chrono::steady_clock::now()) {}

void FitLog::BeginStage(int stage, int num_stages,
                        Eigen::Index segment_samples) {
  stage_ = stage;
  num_stages_ = num_stages;
  segment_samples_ = segment_samples;
}

bool FitLog::Note(IterationRecord iteration, const Vector& free) {
  iteration.stage = stage_;
  iteration.segment_samples = segment_samples_;
  iteration.seconds = SecondsSince(begin_);
  summary_.iterations.push_back(iteration);
  VLOG(1) << "stage " << iteration.stage << " iteration " << iteration.iteration
          << " cost " << iteration.cost << " gap " << iteration.largest_gap
          << " radius " << iteration.trust_region_radius
          << (iteration.accepted ? "" : " rejected");
  return GoOn(free, iteration.cost, iteration.largest_gap);
}

bool FitLog::GoOn(const Vector& free, double cost, double largest_gap) {
  if (!options_.callback) return true;
  // The call may measure the error of the simulation again.
  const IdentifiedModel model = model_to_keep_(free);
  IdentificationProgress progress;
  progress.model = &model;
  progress.stage = stage_;
  progress.num_stages = num_stages_;
  progress.segment_samples = segment_samples_;
  progress.iteration =
      summary_.iterations.empty() ? 0 : summary_.iterations.back().iteration;
  progress.cost = cost;
  progress.largest_gap = largest_gap;
  progress.free_run_error = free_run_error_;
  progress.elapsed_seconds = SecondsSince(begin_);
  if (progress.iteration > 0) {
    progress.expected_seconds = progress.elapsed_seconds *
                                options_.max_num_iterations /
                                progress.iteration;
  }
  // Ranks continue together or not at all.
  interrupted_ = !CommunicatorOrSingle(options_.communicator)
                      .AllTrue(!interrupted_ && options_.callback(progress));
  return !interrupted_;
}

}  // namespace pinode
