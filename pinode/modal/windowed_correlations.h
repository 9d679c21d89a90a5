// Correlation functions of a record, window of time by window of time.

#ifndef PINODE_MODAL_WINDOWED_CORRELATIONS_H_
#define PINODE_MODAL_WINDOWED_CORRELATIONS_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Of channels y and references y' (some of the channels), for lags 1 ... L in
// samples,
//
//   R_l = sum over k of h(k) y(k + l) y'(k)^T / sum of h(k)
//
// of each of several windows h: Hann's, of equal length, each half over the
// next. Their mean is the estimate; how they differ says how sure it is. They
// are tapered because products of a vibration's samples fluctuate most where it
// does no harm, at twice its frequency: windows with edges would count that.
struct WindowedCorrelations {
  int num_channels = 0;
  int num_references = 0;
  int num_lags = 0;
  Eigen::Index window_samples = 0;
  // Per window L channels x references: rows (l - 1) * channels on are R_l.
  std::vector<Matrix> windows;
  Matrix mean;  // over the windows
  // R_0 of the references with one another, over all samples.
  Matrix zero_lag;

  int num_windows() const { return static_cast<int>(windows.size()); }
};

// Of `samples` (channels x samples, of mean zero; NaN: missing, such products
// do not count) in `num_windows`, 4 * samples * channels * references * lags
// operations. references: indices of channels. There are more samples than
// num_lags + num_windows.
WindowedCorrelations CorrelateWindows(const Matrix& samples,
                                      const std::vector<int>& references,
                                      int num_lags, int num_windows,
                                      int num_threads);

// How the estimate's uncertainty follows from what the windows say.
//
// What moves a mode fluctuates as slowly as the mode's energy does, within
// 1 / (2 zeta omega): windows must be longer than that to count it all. Longer
// ones are made of several, weighed by Hann's shape: they are as smooth.
class WindowSmoother {
 public:
  // `length` in windows' lengths, at least 1; no longer than leaves
  // kFewestWindows of them.
  WindowSmoother(int num_windows, double length);

  // Rows: quantities; columns: windows. Columns of the result have the mean
  // zero, and result * result^T is the covariance of the mean over windows.
  Matrix Smooth(const Matrix& influences) const;

  // Of that covariance: of Student's t.
  double degrees_of_freedom() const { return degrees_of_freedom_; }

  static constexpr int kFewestWindows = 10;

 private:
  Matrix weights_;  // windows x longer windows
  double degrees_of_freedom_ = 0.0;
};

}  // namespace pinode

#endif  // PINODE_MODAL_WINDOWED_CORRELATIONS_H_
