#include "pinode/problem/ambient_spectrum.h"

#include <cmath>
#include <complex>
#include <random>

#include "gtest/gtest.h"
#include "pinode/base/constants.h"

namespace pinode {
namespace {

constexpr double kSamplingStep = 0.01;

// x_k = 2 r cos(w) x_k-1 - r^2 x_k-2 + noise of unit variance: a mode at 2 Hz
// of half a per cent of damping, alone.
constexpr double kModeHz = 2.0;
constexpr double kModeRatio = 0.005;

Vector SimulatedMode(Eigen::Index size, unsigned seed) {
  constexpr Eigen::Index kRunIn = 20000;
  const double w = kTwoPi * kModeHz * kSamplingStep;
  const double r = std::exp(-kModeRatio * w);
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Vector x(kRunIn + size);
  x[0] = x[1] = 0.0;
  for (Eigen::Index k = 2; k < x.size(); ++k) {
    x[k] =
        2.0 * r * std::cos(w) * x[k - 1] - r * r * x[k - 2] + normal(generator);
  }
  return x.tail(size);
}

// One-sided.
double DensityOfMode(double frequency) {
  const double w = kTwoPi * kModeHz * kSamplingStep;
  const double r = std::exp(-kModeRatio * w);
  const std::complex<double> z =
      std::polar(1.0, -kTwoPi * frequency * kSamplingStep);
  return 2.0 * kSamplingStep /
         std::norm(1.0 - 2.0 * r * std::cos(w) * z + r * r * z * z);
}

// Means of lines over what they should be, from 10 to 30 Hz, where the density
// is a thousandth of a millionth of the peak's.
double RatioFarFromMode(const Matrix& samples) {
  const SpectralLines lines =
      FindSpectralLines(samples, kSamplingStep, 1.0, 30.0);
  double sum = 0.0;
  double count = 0.0;
  for (Eigen::Index k = 0; k < lines.frequency.size(); ++k) {
    if (lines.frequency[k] < 10.0) continue;
    sum += std::norm(lines.values(0, k)) / DensityOfMode(lines.frequency[k]);
    count += 1.0;
  }
  return sum / count;
}

TEST(SpectralLinesTest, DensityWithoutAndWithAGap) {
  Matrix samples(1, 60000);
  samples.row(0) = SimulatedMode(60000, 1).transpose();
  EXPECT_NEAR(RatioFarFromMode(samples), 1.0, 0.05);
  samples.middleCols(20000, 3000).setConstant(std::nan(""));
  EXPECT_NEAR(RatioFarFromMode(samples), 1.0, 0.05);
  samples.middleCols(41000, 2500).setConstant(std::nan(""));
  EXPECT_NEAR(RatioFarFromMode(samples), 1.0, 0.05);
}

// A gap of one channel is one of all: their products stay what they are.
TEST(SpectralLinesTest, ChannelsAreCutTogether) {
  Matrix samples(2, 60000);
  samples.row(0) = SimulatedMode(60000, 2).transpose();
  samples.row(1) = -3.0 * samples.row(0);
  samples.row(0).segment(20000, 3000).setConstant(std::nan(""));
  const SpectralLines lines =
      FindSpectralLines(samples, kSamplingStep, 1.0, 30.0);
  EXPECT_LT((lines.values.row(1) + 3.0 * lines.values.row(0)).norm(),
            1e-9 * lines.values.row(1).norm());
  EXPECT_NEAR(ShareOutsideGaps(samples), 0.95, 1e-12);
  // A few samples in a row are no gap.
  samples.row(1).segment(100, 4).setConstant(std::nan(""));
  EXPECT_NEAR(ShareOutsideGaps(samples), 0.95, 1e-12);
}

// A cosine over a twentieth of the record at either end, by hand.
TEST(SpectralLinesTest, WhatTheTaperDoes) {
  const Eigen::Index size = 64800;
  Matrix samples(1, size);
  samples.row(0) = SimulatedMode(size, 3).transpose();
  const SpectralLines lines =
      FindSpectralLines(samples, kSamplingStep, 1.0, 30.0);
  const double square = 0.9 + 0.1 * 3.0 / 8.0;
  EXPECT_NEAR(lines.tied, (0.9 + 0.1 * 35.0 / 128.0) / (square * square), 1e-6);
  const double slope = kPi * kPi / 4.0 / 0.05 / square;  // over T^2
  EXPECT_NEAR(
      lines.bandwidth,
      std::sqrt(slope) / kTwoPi / (static_cast<double>(size) * kSamplingStep),
      1e-4 * lines.bandwidth);
  // Groups count independent lines, and hold all there is.
  const LineGroups groups = GroupLines(lines, 0.01);
  EXPECT_NEAR(groups.count.sum() * lines.tied,
              static_cast<double>(lines.frequency.size()), 1e-6);
  double sum = 0.0;
  for (const ComplexMatrix& product : groups.products) {
    sum += product(0, 0).real();
  }
  EXPECT_NEAR(sum * lines.tied, lines.values.squaredNorm(),
              1e-9 * lines.values.squaredNorm());
  // Evenly spaced lines over a band of a hundredth.
  const Eigen::Index last = groups.size() - 2;
  EXPECT_NEAR(groups.spread[last],
              0.01 * groups.frequency[last] / std::sqrt(12.0),
              0.02 * groups.spread[last]);
}

// Powers, and covariances of full rank and of less.
TEST(LoadSpectrumTest, RefinedIsTheSameSpectrum) {
  LoadSpectrum coarse(0.5, 11.0, 3, 2, /*correlated=*/true);
  Vector unknowns(9);
  unknowns << 1.0, -0.4, 0.3, 0.5, 0.9, 0.0, 0.02, 0.1, 0.2;
  coarse.SetPowers(unknowns);
  Vector refined;
  const LoadSpectrum finer = coarse.Refined(unknowns, &refined);
  ASSERT_EQ(finer.num_knots(), 5);
  const auto at = [](const LoadSpectrum& spectrum, const Vector& entries,
                     double frequency) {
    double below = 0.0;
    double above = 0.0;
    const int knot = spectrum.Weigh(frequency, &below, &above);
    const Matrix root = spectrum.Root(entries, knot);
    const Matrix next = spectrum.Root(entries, knot + 1);
    return Matrix(below * root * root.transpose() +
                  above * next * next.transpose());
  };
  for (double f = 0.5; f < 11.0; f *= 1.03) {
    const Matrix before = at(coarse, unknowns, f);
    EXPECT_LT((at(finer, refined, f) - before).norm(), 1e-12 * before.norm())
        << f;
  }
}

}  // namespace
}  // namespace pinode
