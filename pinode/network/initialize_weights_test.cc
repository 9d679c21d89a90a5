#include "pinode/network/initialize_weights.h"

#include <cmath>

#include "gtest/gtest.h"

namespace pinode {
namespace {

NetworkArchitecture WideNetwork(Activation activation) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 100;
  architecture.num_outputs = 50;
  architecture.hidden_widths = {300, 200};
  architecture.activation = activation;
  return architecture;
}

// Mean and standard deviation of n draws, within five of their own standard
// deviations; and a normal distribution's share within one standard deviation.
void ExpectNormal(const Vector& draws, double deviation) {
  const auto n = static_cast<double>(draws.size());
  EXPECT_NEAR(draws.mean(), 0.0, 5.0 * deviation / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(draws.squaredNorm() / n), deviation,
              5.0 * deviation / std::sqrt(2.0 * n));
  const double inside =
      static_cast<double>((draws.array().abs() < deviation).count()) / n;
  EXPECT_NEAR(inside, 0.682689, 5.0 * std::sqrt(0.682689 * 0.317311 / n));
}

Vector Part(const Vector& weights, const WeightLayout::Part& part) {
  return weights.segment(part.offset, part.size());
}

// Returns the one input of each unit of the first layer; the others are zero.
Vector SingleInputs(const Vector& weights, const WeightLayout& layout) {
  const WeightLayout::Part& part = layout.weights[0];
  const Eigen::Map<const Matrix> first(weights.data() + part.offset, part.rows,
                                       part.cols);
  Vector singles(part.rows);
  for (int i = 0; i < part.rows; ++i) {
    singles[i] = first(i, i % part.cols);
    EXPECT_EQ((first.row(i).array() != 0.0).count(), 1);
  }
  return singles;
}

TEST(InitializeWeights, HasGlorotsVariance) {
  const NetworkArchitecture architecture = WideNetwork(Activation::kTanh);
  const WeightLayout layout = architecture.Layout();
  const Vector weights = InitializeWeights(architecture, 7, false);
  ExpectNormal(SingleInputs(weights, layout), 1.0);
  ExpectNormal(Part(weights, layout.biases[0]), std::sqrt(2.0 / 400.0));
  ExpectNormal(Part(weights, layout.weights[1]), std::sqrt(2.0 / 500.0));
  ExpectNormal(Part(weights, layout.weights[2]), 0.1 * std::sqrt(2.0 / 250.0));
  EXPECT_TRUE(Part(weights, layout.biases[2]).isZero(0.0));
  EXPECT_TRUE(Part(weights, layout.skip).isZero(0.0));
}

TEST(InitializeWeights, HasHesVarianceForRectifiers) {
  for (const Activation activation :
       {Activation::kRelu, Activation::kLeakyRelu}) {
    const NetworkArchitecture architecture = WideNetwork(activation);
    const WeightLayout layout = architecture.Layout();
    const Vector weights = InitializeWeights(architecture, 8, true);
    const double slope = activation == Activation::kRelu ? 0.0 : 0.01;
    const double gain = 2.0 / (1.0 + slope * slope);
    ExpectNormal(SingleInputs(weights, layout), std::sqrt(gain));
    ExpectNormal(Part(weights, layout.weights[1]), std::sqrt(gain / 300.0));
  }
}

TEST(InitializeWeights, ZeroLastLayerLeavesThePhysicsAlone) {
  const NetworkArchitecture architecture = WideNetwork(Activation::kSine);
  const WeightLayout layout = architecture.Layout();
  const Vector weights = InitializeWeights(architecture, 9, true);
  EXPECT_TRUE(weights.tail(layout.size - layout.weights[2].offset).isZero(0.0));
  EXPECT_GT(Part(weights, layout.weights[1]).cwiseAbs().minCoeff(), 0.0);

  NetworkArchitecture linear;
  linear.num_inputs = 2;
  linear.num_outputs = 1;
  EXPECT_TRUE(InitializeWeights(linear, 9, true).isZero(0.0));
  EXPECT_NE(InitializeWeights(linear, 9, false)[0], 0.0);
}

TEST(InitializeWeights, DependsOnTheSeedOnly) {
  const NetworkArchitecture architecture = WideNetwork(Activation::kTanh);
  const Vector weights = InitializeWeights(architecture, 1, false);
  EXPECT_EQ(weights, InitializeWeights(architecture, 1, false));
  EXPECT_FALSE(weights.head(100).isApprox(
      InitializeWeights(architecture, 2, false).head(100), 0.1));
}

// The result is the same with any standard library: the C++ standard fixes the
// 10000th number of the engine, and Box and Muller's formula fixes the rest.
// Reference: the engine and the formula in Python's integers and floats.
TEST(InitializeWeights, IsTheSameOnEveryPlatform) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 1;
  architecture.num_outputs = 1;
  architecture.hidden_widths = {1};
  const Vector weights = InitializeWeights(architecture, 5489, true);
  EXPECT_NEAR(weights[0], -0.0020899072880723488, 1e-14);
  EXPECT_NEAR(weights[1], 0.69246281623767536, 1e-14);
}

}  // namespace
}  // namespace pinode
