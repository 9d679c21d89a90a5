// Correlation functions of a record, computed in windows of time.

#ifndef PINODE_MODAL_WINDOWED_CORRELATIONS_H_
#define PINODE_MODAL_WINDOWED_CORRELATIONS_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Correlations of channels y and references y' (some of the channels), for lags
// 1 ... L in samples,
//
//   R_l = sum over k of h(k) y(k + l) y'(k)^T / sum of h(k)
//
// for each of several windows h. They are Hann windows of equal length that
// overlap by half. Their mean is the estimate, and their scatter gives its
// uncertainty. The windows are tapered because products of a vibration's
// samples fluctuate most at twice its frequency, which does not affect the
// estimate. Windows with sharp edges would count that fluctuation.
struct WindowedCorrelations {
  int num_channels = 0;
  int num_references = 0;
  int num_lags = 0;
  Eigen::Index window_samples = 0;
  // Per window L channels x references. Rows from (l - 1) * channels on are
  // R_l.
  std::vector<Matrix> windows;
  Matrix mean;  // over the windows
  // R_0 between the references, over all samples.
  Matrix zero_lag;

  int num_windows() const { return static_cast<int>(windows.size()); }
};

// Computes the correlations of `samples` in `num_windows` windows. `samples`:
// channels x samples, of mean zero; NaN: missing, products with it do not
// count. references: indices of channels. There must be more samples than
// num_lags + num_windows. The cost is 4 * samples * channels * references *
// lags operations.
WindowedCorrelations CorrelateWindows(const Matrix& samples,
                                      const std::vector<int>& references,
                                      int num_lags, int num_windows,
                                      int num_threads);

// Computes the estimate's uncertainty from the windows.
//
// The fluctuations that move a mode are as slow as the mode's energy, 1 / (2
// zeta omega). Windows must be longer than that to include them completely.
// Longer windows are sums of several, weighted by Hann's shape, and equally
// smooth.
class WindowSmoother {
 public:
  // `length` is in windows' lengths, at least 1. It is limited so that
  // kFewestWindows of them remain.
  WindowSmoother(int num_windows, double length);

  // Smooths `influences` (quantities x windows). Columns of the result have the
  // mean zero. result * result^T is the covariance of the mean over windows.
  Matrix Smooth(const Matrix& influences) const;

  // Degrees of freedom of that covariance, for Student's t.
  double degrees_of_freedom() const { return degrees_of_freedom_; }

  static constexpr int kFewestWindows = 10;

 private:
  Matrix weights_;  // windows x longer windows
  double degrees_of_freedom_ = 0.0;
};

}  // namespace pinode

#endif  // PINODE_MODAL_WINDOWED_CORRELATIONS_H_
