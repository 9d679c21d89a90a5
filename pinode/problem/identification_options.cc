#include "pinode/problem/identification_options.h"

#include <sstream>

#include "pinode/base/parallel_for.h"

namespace pinode {

bool IdentificationOptions::IsValid(std::string* error) const {
  std::ostringstream message;
  if (segment_samples < 0) {
    message << "segment_samples is " << segment_samples
            << ", it must not be negative (0: chosen)";
  } else if (segment_samples > 0 && segment_samples < 2) {
    message << "segment_samples is 1, a segment needs at least two samples";
  } else if (max_num_iterations < 1) {
    message << "max_iterations is " << max_num_iterations
            << ", it must be at least 1";
  } else if (!(function_tolerance > 0.0 && function_tolerance < 1.0)) {
    message << "tolerance is " << function_tolerance
            << ", it must lie between 0 and 1";
  } else if (!(loss_scale > 0.0)) {
    message << "robust_scale is " << loss_scale << ", it must be positive";
  } else if (num_starts < 0) {
    message << "multistart is " << num_starts << ", it must be at least 0";
  } else if (num_threads < 1 || num_threads > kMostThreads) {
    message << "threads is " << num_threads << ", it must be from 1 to "
            << kMostThreads;
  } else {
    return true;
  }
  *error = message.str();
  return false;
}

bool IdentificationOptions::GivesIntervals(std::string* error) const {
  if (covariance != Covariance::kNone) return true;
  *error = "covariance is kNone, which gives no intervals";
  return false;
}

}  // namespace pinode
