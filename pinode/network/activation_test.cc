#include "pinode/network/activation.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/network/network_functor.h"

namespace pinode {
namespace {

using Jet = ceres::Jet<double, 1>;

constexpr Activation kAll[] = {Activation::kTanh,     Activation::kSigmoid,
                               Activation::kRelu,     Activation::kLeakyRelu,
                               Activation::kSoftplus, Activation::kSine,
                               Activation::kIdentity};

TEST(Activation, NamesAreReadBack) {
  for (const Activation activation : kAll) {
    Activation parsed = Activation::kIdentity;
    std::string error;
    EXPECT_TRUE(ParseActivation(ActivationName(activation), &parsed, &error));
    EXPECT_EQ(parsed, activation);
  }
}

TEST(Activation, UnknownNameSuggestsKnownOnes) {
  Activation parsed = Activation::kSine;
  std::string error;
  EXPECT_FALSE(ParseActivation("sigmiod", &parsed, &error));
  EXPECT_EQ(parsed, Activation::kSine);
  EXPECT_EQ(error, "unknown activation 'sigmiod'; did you mean 'sigmoid'?");
  EXPECT_FALSE(ParseActivation("", &parsed, &error));
  EXPECT_FALSE(ParseActivation("gaussian_bump", &parsed, &error));
  EXPECT_THAT(error, ::testing::HasSubstr("'gaussian_bump'"));
  EXPECT_THAT(error, ::testing::HasSubstr("leaky_relu, softplus, sine"));
}

// An odd size, so that the vectorised functions end in an incomplete block. The
// values are on both sides of the change of tanh's formula.
std::vector<double> Points() {
  std::vector<double> points;
  for (int i = -30; i <= 30; ++i) points.push_back(0.11 * i);
  for (const double z :
       {-700.0, -40.0, -15.0, -1e-9, 1e-9, 15.0, 40.0, 700.0}) {
    points.push_back(z);
  }
  return points;
}

TEST(Activation, ValueSlopeAndCurvatureAgreeWithJets) {
  const std::vector<double> z = Points();
  const int n = static_cast<int>(z.size());
  for (const Activation activation : kAll) {
    SCOPED_TRACE(ActivationName(activation));
    std::vector<double> value(n), slope(n), curvature(n);
    ApplyActivation(activation, n, z.data(), value.data(), slope.data(),
                    curvature.data());
    for (int i = 0; i < n; ++i) {
      SCOPED_TRACE(z[i]);
      const Jet f = EvaluateActivation(activation, Jet(z[i], 0));
      const Jet df = EvaluateActivationSlope(activation, Jet(z[i], 0));
      const double tolerance = 1e-14;
      EXPECT_NEAR(value[i], f.a, tolerance * std::max(1.0, std::abs(f.a)));
      EXPECT_NEAR(slope[i], f.v[0], tolerance);
      EXPECT_NEAR(df.a, f.v[0], tolerance);
      EXPECT_NEAR(curvature[i], df.v[0], tolerance);
    }
  }
}

TEST(Activation, TanhIsAccurateToAFewRoundings) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  double worst = 0.0;
  for (int i = 1; i < 220000; ++i) {
    // Magnitudes from 1e-10 to 25.
    const double z = i < 20000 ? std::pow(10.0, -10.0 + 5e-4 * i)
                               : 1.25e-4 * (i - 20000 + 1);
    double value[2];
    const double both[] = {z, -z};
    ApplyActivation(Activation::kTanh, 2, both, value, nullptr, nullptr);
    const long double exact = std::tanh(static_cast<long double>(z));
    const auto error = static_cast<double>((value[0] - exact) / exact);
    worst = std::max(worst, std::abs(error));
    ASSERT_EQ(value[1], -value[0]) << z;
  }
  EXPECT_LT(worst, 3 * kEpsilon);
}

TEST(Activation, SaturatesAndKeepsNaN) {
  const double z[] = {kInfinity, -kInfinity};
  double value[2];
  double slope[2];
  ApplyActivation(Activation::kTanh, 2, z, value, slope, nullptr);
  EXPECT_EQ(value[0], 1.0);
  EXPECT_EQ(value[1], -1.0);
  EXPECT_EQ(slope[0], 0.0);
  ApplyActivation(Activation::kSigmoid, 2, z, value, slope, nullptr);
  EXPECT_EQ(value[0], 1.0);
  EXPECT_EQ(value[1], 0.0);
  for (const Activation activation : kAll) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    ApplyActivation(activation, 1, &nan, value, slope, nullptr);
    EXPECT_TRUE(std::isnan(value[0])) << ActivationName(activation);
  }
}

TEST(Activation, KinksTakeTheValueFromTheLeft) {
  const double zero = 0.0;
  double value = 1.0;
  double slope = 1.0;
  double curvature = 1.0;
  ApplyActivation(Activation::kRelu, 1, &zero, &value, &slope, &curvature);
  EXPECT_EQ(value, 0.0);
  EXPECT_EQ(slope, 0.0);
  EXPECT_EQ(curvature, 0.0);
  ApplyActivation(Activation::kLeakyRelu, 1, &zero, &value, &slope, &curvature);
  EXPECT_EQ(value, 0.0);
  EXPECT_EQ(slope, kLeakyReluSlope);
  EXPECT_EQ(curvature, 0.0);
}

TEST(Activation, WorksInPlace) {
  for (const Activation activation : kAll) {
    std::vector<double> z = Points();
    const int n = static_cast<int>(z.size());
    std::vector<double> value(n), slope(n), curvature(n);
    ApplyActivation(activation, n, z.data(), value.data(), slope.data(),
                    curvature.data());
    std::vector<double> slope_again(n), curvature_again(n);
    ApplyActivation(activation, n, z.data(), z.data(), slope_again.data(),
                    curvature_again.data());
    EXPECT_EQ(z, value) << ActivationName(activation);
    EXPECT_EQ(slope, slope_again) << ActivationName(activation);
    EXPECT_EQ(curvature, curvature_again) << ActivationName(activation);
  }
}

}  // namespace
}  // namespace pinode
