#include "pinode/base/statistics.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <unsupported/Eigen/FFT>

namespace pinode {
namespace {

// Lags that cost less one by one than all of them together by an FFT.
constexpr Eigen::Index kLagsOneByOne = 64;

// Returns values.head(n - k).dot(values.tail(n - k)) for the lags k = 0 ...
// count - 1, as a convolution by Fourier transforms.
Vector LaggedProducts(const Vector& values, Eigen::Index count) {
  Eigen::Index size = 2;
  while (size < values.size() + count) size *= 2;
  Vector padded = Vector::Zero(size);
  padded.head(values.size()) = values;
  Eigen::FFT<double> fft;
  Eigen::VectorXcd spectrum;
  fft.fwd(spectrum, padded);
  spectrum = spectrum.cwiseAbs2().cast<std::complex<double>>();
  fft.inv(padded, spectrum);
  return padded.head(count);
}

// Mean over the present samples of function(x).
template <typename Function>
double MeanOf(const Eigen::Ref<const Vector>& values,
              const Function& function) {
  double sum = 0.0;
  Eigen::Index count = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += function(value);
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : sum / static_cast<double>(count);
}

}  // namespace

double Median(std::vector<double> values) {
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Eigen::Index CountPresent(const Vector& values) {
  return std::count_if(values.begin(), values.end(),
                       [](double value) { return !std::isnan(value); });
}

double MeanOfPresent(const Eigen::Ref<const Vector>& values) {
  return MeanOf(values, [](double value) { return value; });
}

double RmsOfPresent(const Vector& values) {
  return std::sqrt(MeanOf(values, [](double value) { return value * value; }));
}

double StandardDeviationOfPresent(const Vector& values) {
  return StatisticsOfPresent(values).StandardDeviation();
}

SeriesStatistics StatisticsOfPresent(const Vector& values) {
  SeriesStatistics statistics;
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    squares += value * value;
    ++statistics.count;
  }
  const auto count = static_cast<double>(statistics.count);
  statistics.mean = sum / count;  // NaN where there are none
  statistics.rms = std::sqrt(squares / count);
  for (const double value : values) {
    if (std::isnan(value)) continue;
    const double deviation = value - statistics.mean;
    statistics.variation += deviation * deviation;
  }
  return statistics;
}

double SeriesStatistics::StandardDeviation() const {
  return std::sqrt(variation / static_cast<double>(count));
}

double LjungBoxExcess(const Vector& residuals, int num_lags) {
  const Eigen::Index n = residuals.size();
  const double variance = residuals.squaredNorm();
  if (n <= 2 * num_lags || !(variance > 0.0)) return 0.0;
  double statistic = 0.0;
  for (int k = 1; k <= num_lags; ++k) {
    const double rho =
        residuals.head(n - k).dot(residuals.tail(n - k)) / variance;
    statistic += rho * rho / static_cast<double>(n - k);
  }
  statistic *= static_cast<double>(n) * static_cast<double>(n + 2);
  return (statistic - num_lags) / std::sqrt(2.0 * num_lags);
}

double AutocorrelationTime(const Vector& residuals) {
  const Eigen::Index n = residuals.size();
  const double variance = residuals.squaredNorm();
  if (!(variance > 0.0) || !std::isfinite(variance)) return 1.0;
  double time = 1.0;
  Vector products;
  for (Eigen::Index k = 1; k < n / 2; ++k) {
    // Computed one by one, the lags would cost as many operations as the square
    // of the record's length.
    if (k == kLagsOneByOne) products = LaggedProducts(residuals, n / 2);
    const double product =
        k < kLagsOneByOne ? residuals.head(n - k).dot(residuals.tail(n - k))
                          : products[k];
    const double rho = product / variance;
    if (rho < 0.05) break;
    time += 2.0 * rho;
  }
  return time;
}

void MemorylessPart::Add(double residual) {
  if (residual == 0.0) return;
  if (last_ != 0.0) {
    sum_ += 0.5 * (residual - last_) * (residual - last_);
    ++count_;
  }
  last_ = residual;
}

double MemorylessMeanSquare(const Vector& residuals) {
  MemorylessPart part;
  for (const double residual : residuals) part.Add(residual);
  return part.MeanSquare();
}

DifferencedVariance VarianceOfDifferences(const Vector& values) {
  constexpr int kOrder = 8;
  constexpr double kSquares = 12870.0;  // C(16, 8), the sum of their squares
  // Sum of the squared correlations of such differences of white noise, C(32,
  // 16) / C(16, 8)^2. The number of independent differences is smaller by this
  // factor.
  constexpr double kCorrelation = 601080390.0 / (kSquares * kSquares);
  // NaN spreads to the differences that a missing sample enters.
  Vector differences = values;
  for (int i = 0; i < kOrder && differences.size() > 0; ++i) {
    const Eigen::Index n = differences.size() - 1;
    differences = (differences.tail(n) - differences.head(n)).eval();
  }
  DifferencedVariance variance;
  const Eigen::Index count = CountPresent(differences);
  if (count == 0) return variance;
  const double rms = RmsOfPresent(differences);
  variance.value = rms * rms / kSquares;
  variance.deviation = variance.value * std::sqrt(2.0 * kCorrelation /
                                                  static_cast<double>(count));
  return variance;
}

double StudentQuantile(double degrees) {
  constexpr double z = 1.959963984540054;
  if (!(degrees >= 1.0)) degrees = 1.0;
  const double z3 = z * z * z;
  const double z5 = z3 * z * z;
  const double z7 = z5 * z * z;
  const double z9 = z7 * z * z;
  const double d = degrees;
  return z + (z3 + z) / (4.0 * d) +
         (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * d * d) +
         (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * d * d * d) +
         (79.0 * z9 + 776.0 * z7 + 1482.0 * z5 - 1920.0 * z3 - 945.0 * z) /
             (92160.0 * d * d * d * d);
}

double ChiSquareProbability(double value, double degrees) {
  const double spread = 2.0 / (9.0 * degrees);
  const double normal =
      (std::cbrt(std::max(0.0, value) / degrees) - 1.0 + spread) /
      std::sqrt(spread);
  return 0.5 * std::erfc(normal / std::sqrt(2.0));
}

}  // namespace pinode
