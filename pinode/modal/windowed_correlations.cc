#include "pinode/modal/windowed_correlations.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/parallel_for.h"

namespace pinode {
namespace {

// Number of samples in one matrix multiplication: its operands stay in the
// cache.
constexpr Eigen::Index kStretch = 2048;

Matrix Rows(const Matrix& samples, const std::vector<int>& rows) {
  Matrix result(static_cast<Eigen::Index>(rows.size()), samples.cols());
  for (size_t i = 0; i < rows.size(); ++i) {
    result.row(static_cast<Eigen::Index>(i)) = samples.row(rows[i]);
  }
  return result;
}

// Hann's window at its inner points (none of its values is zero).
Vector Hann(Eigen::Index size) {
  Vector h(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    h[k] = 0.5 - 0.5 * std::cos(kTwoPi * (static_cast<double>(k) + 0.5) /
                                static_cast<double>(size));
  }
  return h;
}

// Returns the sum over k of h(k) y(first + k + l) y'(first + k)^T, stacked by
// lag. y (channels x samples) and y' are stored sample by sample. The stacked
// y(k + 1) ... y(k + L) are therefore successive numbers in memory, and nothing
// is copied.
Matrix SumProducts(const Matrix& y, const Matrix& references,
                   Eigen::Index first, const Vector& h, int num_lags) {
  const Eigen::Index channels = y.rows();
  Matrix sums = Matrix::Zero(channels * num_lags, references.rows());
  for (Eigen::Index begin = 0; begin < h.size(); begin += kStretch) {
    const Eigen::Index size = std::min(kStretch, h.size() - begin);
    const Eigen::Map<const Matrix, 0, Eigen::OuterStride<>> later(
        y.data() + (first + begin + 1) * channels, channels * num_lags, size,
        Eigen::OuterStride<>(channels));
    const Matrix weighed =
        h.segment(begin, size).asDiagonal() *
        references.middleCols(first + begin, size).transpose();
    sums.noalias() += later * weighed;
  }
  return sums;
}

}  // namespace

WindowedCorrelations CorrelateWindows(const Matrix& samples,
                                      const std::vector<int>& references,
                                      int num_lags, int num_windows,
                                      int num_threads) {
  const Eigen::Index starts = samples.cols() - num_lags;
  CHECK(num_lags > 0 && num_windows > 0 && starts > num_windows)
      << samples.cols() << " samples are too few for " << num_lags
      << " lags and " << num_windows << " windows";
  WindowedCorrelations result;
  result.num_channels = static_cast<int>(samples.rows());
  result.num_references = static_cast<int>(references.size());
  result.num_lags = num_lags;
  const bool has_gaps = samples.hasNaN();
  Matrix values;
  Matrix present;  // 1 and 0
  if (has_gaps) {
    values = samples.unaryExpr([](double v) { return v == v ? v : 0.0; });
    present = samples.unaryExpr([](double v) { return v == v ? 1.0 : 0.0; });
  }
  const Matrix& y = has_gaps ? values : samples;
  const Matrix reference_values = Rows(y, references);
  const Matrix reference_present =
      has_gaps ? Rows(present, references) : Matrix();
  const Eigen::Index hop = starts / (num_windows + 1);
  result.window_samples = 2 * hop;
  const Vector h = Hann(2 * hop);
  result.windows.resize(static_cast<size_t>(num_windows));
  ParallelFor(num_windows, num_threads, [&](int w, int) {
    Matrix sums = SumProducts(y, reference_values, w * hop, h, num_lags);
    if (has_gaps) {
      // A correlation without any pair of samples is taken as zero.
      sums = sums.cwiseQuotient(
          SumProducts(present, reference_present, w * hop, h, num_lags)
              .cwiseMax(1e-3));
    } else {
      sums /= h.sum();
    }
    result.windows[static_cast<size_t>(w)] = std::move(sums);
  });
  result.mean = Matrix::Zero(samples.rows() * num_lags, result.num_references);
  for (const Matrix& window : result.windows) result.mean += window;
  result.mean /= num_windows;
  result.zero_lag = reference_values * reference_values.transpose();
  if (has_gaps) {
    result.zero_lag =
        result.zero_lag
            .cwiseQuotient((reference_present * reference_present.transpose())
                               .cwiseMax(1.0))
            .eval();
  } else {
    result.zero_lag /= static_cast<double>(samples.cols());
  }
  return result;
}

WindowSmoother::WindowSmoother(int num_windows, double length) {
  // Hops of half a window: num_windows + 1 of them are the record. A window of
  // 2 m hops (m an integer) weighs 2 m - 1 windows of two.
  const int most = std::max(1, (num_windows + 1) / (kFewestWindows + 1));
  const int m = std::clamp(static_cast<int>(std::ceil(length)), 1, most);
  const Eigen::Index members = 2 * m - 1;
  Vector shape(members);
  for (Eigen::Index i = 0; i < members; ++i) {
    shape[i] = 0.5 - 0.5 * std::cos(kPi * static_cast<double>(i + 1) / m);
  }
  const Eigen::Index count = (num_windows - members) / m + 1;
  weights_ = Matrix::Zero(num_windows, count);
  for (Eigen::Index w = 0; w < count; ++w) {
    weights_.col(w).segment(w * m, members) = shape;
  }
  // For white noise of one a sample and hops of length one: sum h of a window
  // of two hops is 1, sum h^2 is 3/4, and 1/8 with its neighbour.
  Matrix products = 0.75 * Matrix::Identity(num_windows, num_windows);
  products.diagonal(1).setConstant(0.125);
  products.diagonal(-1).setConstant(0.125);
  Matrix covariance = weights_.transpose() * products * weights_;
  const double mass = shape.sum();
  const double variance = covariance(0, 0) / (mass * mass);
  // The mean over all windows reduces the variance.
  const double left = 1.0 / static_cast<double>(num_windows + 1);
  const double scale = left / std::max(variance - left, 0.1 * variance) /
                       static_cast<double>(count);
  covariance /= covariance(0, 0);
  degrees_of_freedom_ = std::max(
      1.0, static_cast<double>(count * count) / covariance.squaredNorm() - 1.0);
  weights_ *= std::sqrt(scale) / mass;
}

Matrix WindowSmoother::Smooth(const Matrix& influences) const {
  return (influences.colwise() - influences.rowwise().mean()) * weights_;
}

}  // namespace pinode
