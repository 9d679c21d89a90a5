#include "pinode/modal/windowed_correlations.h"

#include <cmath>
#include <random>

#include "gtest/gtest.h"
#include "pinode/base/constants.h"

namespace pinode {
namespace {

Matrix NoiseSamples(Eigen::Index channels, Eigen::Index samples,
                    unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return Matrix::NullaryExpr(
      channels, samples,
      [&](Eigen::Index, Eigen::Index) { return normal(random); });
}

TEST(WindowedCorrelationsTest, AreTheWeighedMeansOfProducts) {
  const Matrix y = NoiseSamples(3, 500, 1);
  constexpr int kLags = 5;
  constexpr int kWindows = 4;
  const WindowedCorrelations result =
      CorrelateWindows(y, {2, 0}, kLags, kWindows, 2);
  ASSERT_EQ(result.num_windows(), kWindows);
  const Eigen::Index hop = (500 - kLags) / (kWindows + 1);
  EXPECT_EQ(result.window_samples, 2 * hop);
  for (int w = 0; w < kWindows; ++w) {
    for (int lag = 1; lag <= kLags; ++lag) {
      Matrix sum = Matrix::Zero(3, 2);
      double weight = 0.0;
      for (Eigen::Index k = 0; k < 2 * hop; ++k) {
        const double h =
            std::pow(std::sin(kPi * (static_cast<double>(k) + 0.5) /
                              static_cast<double>(2 * hop)),
                     2);
        const Eigen::Index at = w * hop + k;
        sum.col(0) += h * y.col(at + lag) * y(2, at);
        sum.col(1) += h * y.col(at + lag) * y(0, at);
        weight += h;
      }
      const Matrix difference =
          result.windows[static_cast<size_t>(w)].middleRows(3 * (lag - 1), 3) -
          sum / weight;
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

TEST(WindowedCorrelationsTest, MissingSamplesDoNotCount) {
  // A signal whose correlations are the same in every window.
  Matrix y(1, 4000);
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    y(0, k) = std::sin(0.7 * static_cast<double>(k));
  }
  const WindowedCorrelations whole = CorrelateWindows(y, {0}, 10, 5, 1);
  y.block(0, 900, 1, 100).setConstant(kNaN);
  const WindowedCorrelations gap = CorrelateWindows(y, {0}, 10, 5, 1);
  EXPECT_LT((gap.mean - whole.mean).cwiseAbs().maxCoeff(), 5e-3);
}

// The variance of the mean of a process, over many realisations, compared with
// the smoother's estimate for each.
void ExpectCalibrated(double memory, double length, double tolerance) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  constexpr int kWindows = 100;
  constexpr Eigen::Index kHop = 20;
  constexpr int kTrials = 400;
  const WindowSmoother smoother(kWindows, length);
  double actual = 0.0;
  double said = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Vector z((kWindows + 1) * kHop);
    double value = normal(random) / std::sqrt(1.0 - memory * memory);
    for (double& sample : z) {
      value = memory * value + normal(random);
      sample = value;
    }
    Matrix windows(1, kWindows);
    for (int w = 0; w < kWindows; ++w) {
      double sum = 0.0;
      double weight = 0.0;
      for (Eigen::Index k = 0; k < 2 * kHop; ++k) {
        const double h =
            std::pow(std::sin(kPi * (static_cast<double>(k) + 0.5) /
                              static_cast<double>(2 * kHop)),
                     2);
        sum += h * z[w * kHop + k];
        weight += h;
      }
      windows(0, w) = sum / weight;
    }
    actual += std::pow(windows.mean(), 2);
    said += smoother.Smooth(windows).squaredNorm();
  }
  EXPECT_NEAR(said / actual, 1.0, tolerance)
      << "memory " << memory << ", length " << length;
}

TEST(WindowSmootherTest, KnowsTheVarianceOfAMean) {
  // 400 trials give a variance to 7 %.
  ExpectCalibrated(0.0, 1.0, 0.15);
  ExpectCalibrated(0.0, 4.0, 0.2);
  // A memory of 50 samples in windows of 40, and in windows of 240.
  ExpectCalibrated(0.98, 6.0, 0.25);
}

TEST(WindowSmootherTest, LongerWindowsAreFewer) {
  EXPECT_NEAR(WindowSmoother(100, 1.0).degrees_of_freedom(), 94.0, 3.0);
  const double fewer = WindowSmoother(100, 5.0).degrees_of_freedom();
  EXPECT_LT(fewer, 25.0);
  EXPECT_GT(fewer, 10.0);
  // Windows are only as long as ten of them allow.
  EXPECT_GE(WindowSmoother(100, 1e9).degrees_of_freedom(), 7.0);
}

}  // namespace
}  // namespace pinode
