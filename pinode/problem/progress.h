// What the outside hears of a fit while it runs.

#ifndef PINODE_PROBLEM_PROGRESS_H_
#define PINODE_PROBLEM_PROGRESS_H_

#include <chrono>
#include <functional>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Seconds since `begin`.
double SecondsSince(std::chrono::steady_clock::time_point begin);

// Writes the summary's history and asks the caller whether to go on.
class Progress {
 public:
  // What the fit would be kept as at these free parameters; asked for where
  // there is somebody to tell.
  using ModelToKeep = std::function<IdentifiedModel(const Vector& free)>;

  // `options` and `summary` must outlive this object.
  Progress(const IdentificationOptions& options, ModelToKeep model_to_keep,
           FitSummary* summary);

  void BeginStage(int stage, int num_stages, Eigen::Index segment_samples);
  void set_free_run_error(double error) { free_run_error_ = error; }

  // Notes an iteration (its number, cost, norms and radius filled in) and calls
  // GoOn.
  bool Note(IterationRecord iteration, const Vector& free);
  // Tells the caller where the fit is; false where it is to stop.
  bool GoOn(const Vector& free, double cost, double largest_gap);
  // Whether it was told to.
  bool interrupted() const { return interrupted_; }

 private:
  const IdentificationOptions& options_;
  const ModelToKeep model_to_keep_;
  FitSummary* summary_;
  std::chrono::steady_clock::time_point begin_;
  int stage_ = 0;
  int num_stages_ = 0;
  Eigen::Index segment_samples_ = 0;
  double free_run_error_ = kInfinity;  // the newest one measured
  bool interrupted_ = false;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_PROGRESS_H_
