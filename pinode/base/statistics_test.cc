#include "pinode/base/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <random>

#include "pinode/base/constants.h"
#include "tests/support/gaussian_testing.h"

namespace pinode {
namespace {

Vector Make(std::initializer_list<double> values) {
  Vector result(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), result.begin());
  return result;
}

// x_k = a x_(k-1) + e_k, e of unit variance.
Vector Autoregressive(double a, int count, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Vector values(count);
  double value = 0.0;
  for (double& entry : values) entry = value = a * value + normal(random);
  return values;
}

TEST(Statistics, MedianIsTheUpperOfTwo) {
  EXPECT_EQ(Median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(Median({4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(Median({-1.0}), -1.0);
}

TEST(Statistics, SkipWhatIsMissing) {
  const Vector values = Make({1.0, kNaN, 3.0, kNaN, kNaN, -1.0});
  EXPECT_EQ(CountPresent(values), 3);
  EXPECT_DOUBLE_EQ(MeanOfPresent(values), 1.0);
  EXPECT_DOUBLE_EQ(RmsOfPresent(values), std::sqrt(11.0 / 3.0));
  EXPECT_DOUBLE_EQ(StandardDeviationOfPresent(values), std::sqrt(8.0 / 3.0));
  EXPECT_TRUE(std::isnan(MeanOfPresent(Make({kNaN}))));
  EXPECT_TRUE(std::isnan(RmsOfPresent(Vector())));
  // No cancellation under a large offset.
  const Vector offset = Make({1e9 + 1.0, 1e9 - 1.0, kNaN});
  EXPECT_NEAR(StandardDeviationOfPresent(offset), 1.0, 1e-6);
}

TEST(LjungBoxExcess, TellsWhiteNoiseFromAutoregressive) {
  double sum = 0.0;
  double squares = 0.0;
  const int trials = 200;
  for (int seed = 0; seed < trials; ++seed) {
    const double excess = LjungBoxExcess(
        Autoregressive(0.0, 1000, static_cast<uint64_t>(seed)), 20);
    sum += excess;
    squares += excess * excess;
  }
  // Zero mean and unit variance.
  EXPECT_NEAR(sum / trials, 0.0, 0.25);
  EXPECT_NEAR(squares / trials, 1.0, 0.35);
  // The total is n rho^2 / (1 - rho^2): (1000 * 0.0989 - 0) / sqrt(40).
  EXPECT_NEAR(LjungBoxExcess(Autoregressive(0.3, 1000, 1), 20), 15.6, 8.0);
  EXPECT_EQ(LjungBoxExcess(Vector::Zero(500), 20), 0.0);
  EXPECT_EQ(LjungBoxExcess(Vector::Ones(30), 20), 0.0);
}

TEST(AutocorrelationTime, OfAutoregressiveNoise) {
  for (double a : {0.0, 0.5, 0.8, 0.9}) {
    const double expected = (1.0 + a) / (1.0 - a);
    // The sum ends where the correlation falls below 0.05. The missing part is
    // at most 2 * 0.05 / (1 - a).
    const double cut = a > 0.0 ? 0.1 / (1.0 - a) : 0.0;
    const double time = AutocorrelationTime(Autoregressive(a, 200000, 7));
    EXPECT_LT(time, 1.05 * expected) << a;
    EXPECT_GT(time, 0.95 * expected - cut) << a;
  }
  EXPECT_EQ(AutocorrelationTime(Vector::Zero(10)), 1.0);
}

// With a memory of a thousand samples every lag is needed.
TEST(AutocorrelationTime, OfALongMemory) {
  const Vector values = Autoregressive(0.995, 30000, 3);
  const Eigen::Index n = values.size();
  double expected = 1.0;
  Eigen::Index lags = 0;
  for (Eigen::Index k = 1; k < n / 2; ++k) {
    const double rho =
        values.head(n - k).dot(values.tail(n - k)) / values.squaredNorm();
    if (rho < 0.05) break;
    expected += 2.0 * rho;
    lags = k;
  }
  ASSERT_GT(lags, 200);
  EXPECT_NEAR(AutocorrelationTime(values), expected, 1e-10 * expected);
}

TEST(MemorylessMeanSquare, TellsNoiseFromASmoothSignal) {
  Vector values = 0.5 * Autoregressive(0.0, 20000, 3);
  // For 20000 values the estimate has a relative standard deviation of 0.9 %.
  EXPECT_NEAR(MemorylessMeanSquare(values), 0.25, 0.01);
  const double step = 0.02;
  Vector signal(values.size());
  for (Eigen::Index i = 0; i < signal.size(); ++i) {
    signal[i] = 10.0 * std::sin(step * static_cast<double>(i) + 0.1);
  }
  // A sine of amplitude 10: half the mean square of its differences.
  const double alone = 50.0 * (1.0 - std::cos(step));
  EXPECT_NEAR(MemorylessMeanSquare(signal), alone, 1e-3 * alone);
  EXPECT_NEAR(MemorylessMeanSquare(values + signal), 0.25 + alone, 0.01);
  // Missing samples are skipped.
  for (Eigen::Index i = 0; i < values.size(); i += 3) values[i] = 0.0;
  EXPECT_NEAR(MemorylessMeanSquare(values), 0.25, 0.012);
  EXPECT_EQ(MemorylessMeanSquare(Vector::Zero(10)), 0.0);
  EXPECT_EQ(MemorylessMeanSquare(Vector::Unit(10, 3)), 0.0);
}

TEST(VarianceOfDifferences, IsThatOfTheNoiseBesideAMotion) {
  const Vector noise = 0.5 * Autoregressive(0.0, 20000, 3);
  const DifferencedVariance alone = VarianceOfDifferences(noise);
  EXPECT_NEAR(alone.value, 0.25, 3.0 * alone.deviation);
  EXPECT_NEAR(alone.deviation / alone.value, 0.01905, 1e-5);
  // A sine of amplitude 3, eight samples per period: the share (2 sin(pi /
  // 8))^16 / C(16, 8) of its mean square remains.
  Vector sine(noise.size());
  for (Eigen::Index i = 0; i < sine.size(); ++i) {
    sine[i] = 3.0 * std::sin(0.25 * kPi * static_cast<double>(i) + 0.1);
  }
  const double left = 4.5 * std::pow(2.0 * std::sin(kPi / 8.0), 16.0) / 12870.0;
  EXPECT_NEAR(VarianceOfDifferences(sine).value, left, 1e-3 * left);
  EXPECT_NEAR(VarianceOfDifferences(noise + sine).value, alone.value, 1e-4);
  // The standard deviation is the scatter over stretches of the series, within
  // its own 7 %.
  const Vector gaussian = 0.5 * testing::Gaussian(4).Draw(20000);
  Vector stretches(100);
  for (Eigen::Index k = 0; k < stretches.size(); ++k) {
    stretches[k] = VarianceOfDifferences(gaussian.segment(200 * k, 200)).value;
  }
  const double spread = 0.25 * std::sqrt(2.0 * 3.6289 / 192.0);
  EXPECT_NEAR(StandardDeviationOfPresent(stretches), spread, 0.2 * spread);
}

TEST(VarianceOfDifferences, PassesOverGaps) {
  const double missing = std::nan("");
  Vector values = 0.5 * Autoregressive(0.0, 20000, 3);
  for (Eigen::Index i = 0; i < values.size(); i += 20) values[i] = missing;
  const DifferencedVariance variance = VarianceOfDifferences(values);
  EXPECT_NEAR(variance.value, 0.25, 3.0 * variance.deviation);
  EXPECT_EQ(VarianceOfDifferences(Vector::Constant(30, missing)).value, 0.0);
  EXPECT_EQ(VarianceOfDifferences(Vector::Ones(8)).value, 0.0);
  EXPECT_EQ(VarianceOfDifferences(Vector()).deviation, 0.0);
}

// NIST/SEMATECH e-Handbook, section 1.3.6.7.2.
TEST(StudentQuantile, EqualsTheTable) {
  EXPECT_NEAR(StudentQuantile(5.0), 2.571, 3e-3);
  EXPECT_NEAR(StudentQuantile(10.0), 2.228, 1e-3);
  EXPECT_NEAR(StudentQuantile(12.0), 2.179, 1e-3);
  EXPECT_NEAR(StudentQuantile(30.0), 2.042, 1e-3);
  EXPECT_NEAR(StudentQuantile(100.0), 1.984, 1e-3);
  EXPECT_NEAR(StudentQuantile(1e6), 1.95996, 1e-4);
}

}  // namespace
}  // namespace pinode
