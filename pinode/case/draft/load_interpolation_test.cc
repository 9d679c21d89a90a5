#include "pinode/case/draft/load_interpolation.h"

#include <cmath>
#include <random>

#include "gtest/gtest.h"

namespace pinode {
namespace {

Vector Sine(double cycles_per_sample) {
  Vector load(4000);
  for (Eigen::Index k = 0; k < load.size(); ++k) {
    load[k] = std::sin(6.283185307179586 * cycles_per_sample *
                       static_cast<double>(k));
  }
  return load;
}

Vector White() {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Vector load(4000);
  for (double& value : load) value = normal(random);
  return load;
}

TEST(LoadInterpolationTest, SmoothLoadsAreCubic) {
  const LoadInterpolation found = FindLoadInterpolation({Sine(0.05)});
  EXPECT_TRUE(found.is_cubic);
  // 1 - cos(w) of a line; 1 - (9 cos(w) - cos(3 w)) / 8 of a cubic.
  const double w = 6.283185307179586 * 0.05;
  EXPECT_NEAR(found.linear_error, 1.0 - std::cos(w), 1e-3);
  EXPECT_NEAR(found.cubic_error,
              1.0 - (9.0 * std::cos(w) - std::cos(3.0 * w)) / 8.0, 1e-3);
}

TEST(LoadInterpolationTest, LoadsNearHalfTheRateAreLinear) {
  const LoadInterpolation white = FindLoadInterpolation({White()});
  EXPECT_FALSE(white.is_cubic);
  EXPECT_NEAR(white.linear_error, std::sqrt(1.5), 0.05);
  EXPECT_NEAR(white.cubic_error, std::sqrt(1.0 + 164.0 / 256.0), 0.05);
  EXPECT_FALSE(FindLoadInterpolation({Sine(0.45)}).is_cubic);
  // Noise on top of a smooth load.
  EXPECT_FALSE(
      FindLoadInterpolation({Vector(Sine(0.02) + 0.1 * White())}).is_cubic);
  EXPECT_TRUE(
      FindLoadInterpolation({Vector(Sine(0.05) + 0.002 * White())}).is_cubic);
}

TEST(LoadInterpolationTest, LoadsWithoutMotionSayNothing) {
  EXPECT_TRUE(FindLoadInterpolation({}).is_cubic);
  EXPECT_TRUE(FindLoadInterpolation({Vector::Constant(100, 2.0)}).is_cubic);
  EXPECT_TRUE(FindLoadInterpolation({Vector::Constant(4, 2.0)}).is_cubic);
  EXPECT_TRUE(FindLoadInterpolation({Sine(0.05), Vector::Zero(4000)}).is_cubic);
}

}  // namespace
}  // namespace pinode
