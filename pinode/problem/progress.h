// Progress of a running fit, as reported to the caller.

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

// Returns the seconds since `begin`.
double SecondsSince(std::chrono::steady_clock::time_point begin);

// Writes the summary's history and asks the caller whether to continue.
class Progress {
 public:
  // Returns the model that the fit would keep at these free parameters. Called
  // only if there is a callback to inform.
  using ModelToKeep = std::function<IdentifiedModel(const Vector& free)>;

  // Keeps references to `options` and `summary`, which must outlive this
  // object.
  Progress(const IdentificationOptions& options, ModelToKeep model_to_keep,
           FitSummary* summary);

  void BeginStage(int stage, int num_stages, Eigen::Index segment_samples);
  void set_free_run_error(double error) { free_run_error_ = error; }

  // Records an iteration (its number, cost, norms and radius filled in) and
  // calls GoOn.
  bool Note(IterationRecord iteration, const Vector& free);
  // Reports the state of the fit to the caller; false if the fit is to stop.
  bool GoOn(const Vector& free, double cost, double largest_gap);
  // True if the caller stopped the fit.
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
