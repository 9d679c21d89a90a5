#include "pinode/network/network.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/network/activation.h"
#include "pinode/network/network_functor.h"

namespace pinode {
namespace {

using Jet = ceres::Jet<double, 1>;

constexpr Activation kActivations[] = {
    Activation::kTanh,      Activation::kSigmoid,  Activation::kRelu,
    Activation::kLeakyRelu, Activation::kSoftplus, Activation::kSine,
    Activation::kIdentity};

// Every activation, with and without bias, skip path and gauge, with none to
// three hidden layers, one output and several.
std::vector<NetworkArchitecture> AllArchitectures() {
  std::vector<NetworkArchitecture> all;
  const std::vector<std::vector<int>> widths = {{}, {7}, {5, 9}, {4, 3, 6}};
  for (const Activation activation : kActivations) {
    for (const std::vector<int>& hidden_widths : widths) {
      for (const int num_outputs : {1, 3}) {
        for (const bool bias : {true, false}) {
          for (const bool skip : {true, false}) {
            for (const bool gauge : {true, false}) {
              NetworkArchitecture architecture;
              architecture.num_inputs = 3;
              architecture.num_outputs = num_outputs;
              architecture.hidden_widths = hidden_widths;
              architecture.activation = activation;
              architecture.bias = bias;
              architecture.skip = skip;
              architecture.gauge = gauge;
              architecture.input_scale = Vector(3);
              architecture.input_scale << 0.5, 2.0, 1.25;
              architecture.output_scale =
                  Vector::LinSpaced(num_outputs, 0.5, 3.0);
              std::string error;
              if (architecture.IsValid(&error)) all.push_back(architecture);
            }
          }
        }
      }
    }
  }
  return all;
}

std::string Describe(const NetworkArchitecture& a) {
  std::string text = ActivationName(a.activation);
  for (const int width : a.hidden_widths) text += " " + std::to_string(width);
  return text + " outputs " + std::to_string(a.num_outputs) +
         (a.bias ? " bias" : "") + (a.skip ? " skip" : "") +
         (a.gauge ? " gauge" : "");
}

// Results by Jets of one direction at a time: value, dy/dq, dy/dweights.
struct Oracle {
  Oracle(const NetworkArchitecture& architecture, const Vector& q,
         const Vector& weights) {
    const int num_inputs = architecture.num_inputs;
    const int num_outputs = architecture.num_outputs;
    std::vector<Jet> q_jet(q.begin(), q.end());
    std::vector<Jet> weights_jet(weights.begin(), weights.end());
    std::vector<Jet> y(num_outputs);
    Matrix jacobian(num_outputs, num_inputs + weights.size());
    for (int j = 0; j < jacobian.cols(); ++j) {
      Jet* direction =
          j < num_inputs ? &q_jet[j] : &weights_jet[j - num_inputs];
      direction->v[0] = 1.0;
      EvaluateNetwork(architecture, q_jet.data(), weights_jet.data(), y.data());
      direction->v[0] = 0.0;
      for (int i = 0; i < num_outputs; ++i) jacobian(i, j) = y[i].v[0];
    }
    value.resize(num_outputs);
    for (int i = 0; i < num_outputs; ++i) value[i] = y[i].a;
    dq = jacobian.leftCols(num_inputs);
    dweights = jacobian.rightCols(weights.size());
  }
  Vector value;
  Matrix dq;
  Matrix dweights;
};

// Relative to the largest entry.
void ExpectClose(const Matrix& actual, const Matrix& expected,
                 double tolerance) {
  ASSERT_EQ(actual.rows(), expected.rows());
  ASSERT_EQ(actual.cols(), expected.cols());
  if (expected.size() == 0) return;
  const double scale = std::max(1.0, expected.cwiseAbs().maxCoeff());
  EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(), tolerance * scale);
}

TEST(Network, AgreesWithJets) {
  int count = 0;
  for (const NetworkArchitecture& architecture : AllArchitectures()) {
    SCOPED_TRACE(Describe(architecture));
    const Network network(architecture);
    NetworkWorkspace workspace(network);
    NetworkTangent tangent(network);
    double largest_derivative = 0.0;
    for (int point = 0; point < 8; ++point) {
      const Vector q = Vector::Random(3) * 1.5;
      const Vector weights = Vector::Random(network.num_weights());
      const Oracle oracle(architecture, q, weights);

      Vector y(network.num_outputs());
      network.Evaluate(q.data(), weights.data(), y.data(), &workspace);
      ExpectClose(y, oracle.value, 1e-13);

      // The tangent still contains data of the previous point. They must not
      // matter.
      network.Linearize(q.data(), weights.data(), &tangent);
      EXPECT_EQ(tangent.value(), y);
      ExpectClose(tangent.input_jacobian(), oracle.dq, 1e-12);
      ExpectClose(network.WeightJacobian(tangent), oracle.dweights, 1e-12);
      largest_derivative =
          std::max(largest_derivative, oracle.dweights.cwiseAbs().maxCoeff());
    }
    // Derivatives that are zero everywhere would prove nothing. A gauged
    // network of linear units is zero, and one of rectifiers without a bias
    // may be.
    if (!architecture.gauge ||
        (architecture.bias &&
         architecture.activation != Activation::kIdentity)) {
      EXPECT_GT(largest_derivative, 0.01);
    }
    ++count;
  }
  // 7 activations, 2 numbers of outputs, with and without bias: 3 combinations
  // of skip and gauge with hidden layers, 2 without.
  EXPECT_EQ(count, 7 * 2 * 2 * (3 * 3 + 2));
}

// y = w2 tanh(w1 q / s + b1) + b2 + w3 q / s, and everything by hand.
TEST(Network, ByHand) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 1;
  architecture.num_outputs = 1;
  architecture.hidden_widths = {1};
  architecture.input_scale = Vector::Constant(1, 2.0);
  const Network network(architecture);
  Vector weights(5);
  weights << 0.5, 0.25, 2.0, -1.0, 3.0;
  const double q = 1.0;
  const double t = std::tanh(0.5);
  NetworkTangent tangent(network);
  network.Linearize(&q, weights.data(), &tangent);
  EXPECT_NEAR(tangent.value()[0], 2.0 * t - 1.0 + 1.5, 1e-15);
  EXPECT_NEAR(tangent.input_jacobian()(0, 0),
              (2.0 * (1.0 - t * t) * 0.5 + 3.0) / 2.0, 1e-15);
  Matrix expected(1, 5);
  expected << 2.0 * (1.0 - t * t) * 0.5, 2.0 * (1.0 - t * t), t, 1.0, 0.5;
  ExpectClose(network.WeightJacobian(tangent), expected, 1e-15);
}

TEST(Network, GaugedByHand) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 1;
  architecture.num_outputs = 1;
  architecture.hidden_widths = {1};
  architecture.skip = false;
  architecture.gauge = true;
  const Network network(architecture);
  const double w = 0.75;
  const double b = 0.25;
  const double c = 2.0;
  const Vector weights = (Vector(3) << w, b, c).finished();
  const double q = 1.0;
  const double t = std::tanh(w * q + b);
  const double t0 = std::tanh(b);
  const double s = 1.0 - t * t;
  const double s0 = 1.0 - t0 * t0;
  const double k0 = -2.0 * t0 * s0;
  NetworkTangent tangent(network);
  network.Linearize(&q, weights.data(), &tangent);
  EXPECT_NEAR(tangent.value()[0], c * (t - t0 - s0 * w * q), 1e-15);
  EXPECT_NEAR(tangent.input_jacobian()(0, 0), c * (s - s0) * w, 1e-15);
  Matrix expected(1, 3);
  expected << c * (s - s0) * q, c * (s - s0 - k0 * w * q), t - t0 - s0 * w * q;
  ExpectClose(network.WeightJacobian(tangent), expected, 1e-15);
}

// y(q) = g(q) - g(0) - (dg/dq)(0) q, with g the plain network of the same
// weights: the other side of the gauge's definition.
TEST(Network, GaugeRemovesValueAndSlopeAtRest) {
  for (const NetworkArchitecture& architecture : AllArchitectures()) {
    if (!architecture.gauge) continue;
    SCOPED_TRACE(Describe(architecture));
    const Network gauged(architecture);
    NetworkArchitecture plain_architecture = architecture;
    plain_architecture.gauge = false;
    const Network plain(plain_architecture);
    const Vector weights = Vector::Random(gauged.num_weights());
    // An output bias cancels, whatever it is.
    Vector plain_weights = Vector::Constant(plain.num_weights(), 3.0);
    plain_weights.head(weights.size()) = weights;

    const Vector q = Vector::Random(3);
    const Vector zero = Vector::Zero(3);
    NetworkTangent at_q(plain);
    NetworkTangent at_rest(plain);
    plain.Linearize(q.data(), plain_weights.data(), &at_q);
    plain.Linearize(zero.data(), plain_weights.data(), &at_rest);
    NetworkTangent tangent(gauged);
    gauged.Linearize(q.data(), weights.data(), &tangent);
    ExpectClose(tangent.value(),
                at_q.value() - at_rest.value() - at_rest.input_jacobian() * q,
                1e-13);
    ExpectClose(tangent.input_jacobian(),
                at_q.input_jacobian() - at_rest.input_jacobian(), 1e-13);

    gauged.Linearize(zero.data(), weights.data(), &tangent);
    ExpectClose(tangent.value(), zero.head(gauged.num_outputs()), 1e-15);
    ExpectClose(tangent.input_jacobian(), Matrix::Zero(gauged.num_outputs(), 3),
                1e-15);
  }
}

// Without a bias every kink of a rectifier lies at rest, and its slope there is
// the one from the left. A gauged relu is therefore unchanged, and a gauged
// leaky relu is the rectifier above the left slope.
TEST(Network, GaugedRectifierTakesTheSlopeFromTheLeft) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 1;
  architecture.num_outputs = 1;
  architecture.hidden_widths = {1};
  architecture.bias = false;
  architecture.skip = false;
  architecture.gauge = true;
  const double weights[] = {2.0, 3.0};
  for (const Activation activation :
       {Activation::kRelu, Activation::kLeakyRelu}) {
    architecture.activation = activation;
    const double left = activation == Activation::kRelu ? 0.0 : kLeakyReluSlope;
    const Network network(architecture);
    NetworkWorkspace workspace(network);
    double y = 1.0;
    const double above = 0.5;
    network.Evaluate(&above, weights, &y, &workspace);
    EXPECT_NEAR(y, 6.0 * (1.0 - left) * above, 1e-15);
    const double below = -0.5;
    network.Evaluate(&below, weights, &y, &workspace);
    EXPECT_NEAR(y, 0.0, 1e-15);
  }
}

// The linear part is the slope that remains beside the nonlinear part.
TEST(Network, LinearPartIsTheSlopeOfTheSkipPath) {
  for (const NetworkArchitecture& architecture : AllArchitectures()) {
    if (architecture.gauge || architecture.bias) continue;
    SCOPED_TRACE(Describe(architecture));
    const Network network(architecture);
    Vector weights = Vector::Random(network.num_weights());
    if (!architecture.IsLinear()) {
      const WeightLayout::Part& last = network.layout().weights.back();
      weights.segment(last.offset, last.size()).setZero();
    }
    const Vector q = Vector::Random(3);
    NetworkTangent tangent(network);
    network.Linearize(q.data(), weights.data(), &tangent);
    ExpectClose(LinearPart(architecture, weights), tangent.input_jacobian(),
                1e-15);
    ExpectClose(LinearPart(architecture, weights) * q, tangent.value(), 1e-14);
  }
}

// B += left * dy/dweights, added to existing values, one by one and all at
// once. Row counts fill the tiles of the products, or do not.
TEST(Network, AddsWeightTangents) {
  constexpr int kStages = 4;
  for (const NetworkArchitecture& architecture : AllArchitectures()) {
    SCOPED_TRACE(Describe(architecture));
    const Network network(architecture);
    const Vector weights = Vector::Random(network.num_weights());
    for (const int rows : {1, 5, 8, 15}) {
      NetworkWorkspace workspace(network, 15, kStages);
      std::vector<NetworkTangent> tangents(kStages, NetworkTangent(network));
      std::vector<Matrix> lefts(kStages);
      const NetworkTangent* stage_pointers[kStages];
      const Matrix* left_pointers[kStages];
      const Matrix start = Matrix::Random(rows, network.num_weights());
      Matrix expected = start;
      Matrix one_by_one = start;
      for (int s = 0; s < kStages; ++s) {
        const Vector q = Vector::Random(3);
        network.Linearize(q.data(), weights.data(), &tangents[s]);
        lefts[s] = Matrix::Random(rows, network.num_outputs());
        stage_pointers[s] = &tangents[s];
        left_pointers[s] = &lefts[s];
        expected += lefts[s].lazyProduct(network.WeightJacobian(tangents[s]));
        network.AddWeightTangent(tangents[s], lefts[s], &workspace,
                                 one_by_one.data());
        Matrix batch = start;
        network.AddWeightTangents(stage_pointers, left_pointers, s + 1,
                                  &workspace, batch.data());
        ExpectClose(one_by_one, expected, 1e-13);
        ExpectClose(batch, expected, 1e-13);
      }
    }
  }
}

TEST(NetworkDeathTest, WorkspaceTooSmall) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 1;
  architecture.num_outputs = 1;
  architecture.hidden_widths = {2};
  const Network network(architecture);
  NetworkWorkspace workspace(network, 2, 1);
  const NetworkTangent tangent(network);
  Matrix B = Matrix::Zero(3, network.num_weights());
  EXPECT_DEATH(network.AddWeightTangent(tangent, Matrix::Ones(3, 1), &workspace,
                                        B.data()),
               "as many rows");
}

TEST(NetworkDeathTest, InvalidArchitecture) {
  EXPECT_DEATH(Network{NetworkArchitecture()}, "num_inputs is 0");
}

}  // namespace
}  // namespace pinode
