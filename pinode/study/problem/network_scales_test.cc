#include "pinode/study/problem/network_scales.h"

#include <cmath>
#include <memory>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/network/initialize_weights.h"
#include "pinode/study/problem/checkpoint.h"
#include "pinode/study/problem/make_problem.h"

namespace pinode {
namespace {

// Lengths are multiplied by `length` and times by `time`, masses stay.
struct Units {
  double length = 1.0;
  double time = 1.0;

  double velocity() const { return length / time; }
  double acceleration() const { return velocity() / time; }
};

NetworkTerm Device(ActsAs acts_as) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 4;
  architecture.num_outputs = 1;
  architecture.hidden_widths = {5};
  NetworkTerm term;
  term.name = acts_as == ActsAs::kForce ? "force" : "acceleration";
  term.network = std::make_shared<Network>(architecture);
  term.features = {Feature::Displacement(0), Feature::Deformation(0, 1),
                   Feature::Velocity(1), Feature::Input(0)};
  term.outputs = Vector::Unit(2, 1);
  term.acts_as = acts_as;
  term.weights.name = term.name;
  term.weights.named = false;
  const Vector weights = InitializeWeights(architecture, 7, false);
  for (const double weight : weights) {
    Parameter parameter;
    parameter.name = term.name + std::to_string(term.weights.size());
    parameter.value = weight;
    term.weights.parameters.push_back(parameter);
  }
  return term;
}

// Two storeys under a ground motion, the upper displacement and velocity
// measured.
IdentificationProblem TwoStoreys(const Units& units) {
  StructuralModel model;
  model.dof_names = {"u1", "u2"};
  model.mass = Eigen::Vector2d(3.0, 2.0).asDiagonal();
  model.stiffness.resize(2, 2);
  model.stiffness << 300.0, -100.0, -100.0, 100.0;
  model.stiffness /= units.time * units.time;
  model.damping = 0.01 * model.stiffness * units.time;
  model.influence = Matrix::Ones(2, 1);
  model.support_mass_coupling = Matrix::Zero(2, 1);
  model.directions = {"x"};
  IdentificationProblem problem;
  StructureTerms terms;
  terms.networks = {Device(ActsAs::kForce), Device(ActsAs::kAcceleration)};
  std::string error;
  EXPECT_TRUE(MakeProblem(model, GroundMotion(model), terms, &problem, &error))
      << error;
  constexpr int kSamples = 200;
  Matrix ground(1, kSamples);
  Vector x(kSamples), v(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    // Whole cycles.
    const double angle = 6.283185307179586 * i / 100.0;
    ground(0, i) = 2.0 * std::sin(2.0 * angle) * units.acceleration();
    x[i] = 0.05 * std::sin(angle) * units.length;
    v[i] = 0.25 * std::cos(angle) * units.velocity();
  }
  EXPECT_TRUE(AddRecord(
      "r", 0.01 * units.time, ground, Interpolation::kLinear,
      {MakeMeasuredChannel("x2", Quantity::kDisplacement, Vector::Unit(2, 1),
                           x),
       MakeMeasuredChannel("v2", Quantity::kVelocity, Vector::Unit(2, 1), v)},
      &problem, &error))
      << error;
  EXPECT_TRUE(PrepareProblem(&problem, &error)) << error;
  return problem;
}

const NetworkArchitecture& ArchitectureOf(const IdentificationProblem& problem,
                                          size_t network) {
  return problem.dynamics->networks()[network].network->architecture();
}

TEST(NetworkScales, AreTheSizeOfTheMotion) {
  const IdentificationProblem problem = TwoStoreys(Units());
  const double x = 0.05 / std::sqrt(2.0);
  const double v = 0.25 / std::sqrt(2.0);
  for (const size_t network : {0u, 1u}) {
    const NetworkArchitecture& architecture = ArchitectureOf(problem, network);
    const Vector& input = architecture.input_scale;
    ASSERT_EQ(input.size(), 4);
    // The lower storey moves less, and the two move together.
    EXPECT_LT(input[0], 0.7 * x);
    EXPECT_GT(input[0], 0.2 * x);
    EXPECT_LT(input[1], 0.8 * x);
    EXPECT_NEAR(input[0] + input[1], x, 0.02 * x);
    EXPECT_NEAR(input[2], v, 0.02 * v);
    EXPECT_NEAR(input[3], 2.0 / std::sqrt(2.0), 0.05);
    ASSERT_EQ(architecture.output_scale.size(), 1);
  }
  const double a = v * v / x;
  EXPECT_NEAR(ArchitectureOf(problem, 0).output_scale[0], 2.0 * a, 0.1 * a);
  EXPECT_NEAR(ArchitectureOf(problem, 1).output_scale[0], a, 0.05 * a);
}

// The same weights then mean the same network.
TEST(NetworkScales, FollowTheUnits) {
  const IdentificationProblem plain = TwoStoreys(Units());
  const Units units = {1e4, 1e-3};
  const IdentificationProblem other = TwoStoreys(units);
  for (const size_t network : {0u, 1u}) {
    const Vector& input = ArchitectureOf(plain, network).input_scale;
    Vector expected = input;
    expected[0] *= units.length;
    expected[1] *= units.length;
    expected[2] *= units.velocity();
    expected[3] *= units.acceleration();
    EXPECT_TRUE(
        ArchitectureOf(other, network).input_scale.isApprox(expected, 1e-12));
    EXPECT_NEAR(ArchitectureOf(other, network).output_scale[0] /
                    ArchitectureOf(plain, network).output_scale[0],
                units.acceleration(), 1e-12 * units.acceleration());
  }
}

// Weights learned with other scales are another device.
TEST(NetworkScales, OfNetworksWithMemoryArePartOfTheProblem) {
  const auto hash_with = [](double rate) {
    IdentificationProblem problem = TwoStoreys(Units());
    auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
    MemoryNetworkShape shape;
    shape.deformation = 0.1;
    shape.rate = rate;
    shape.force = 2.0;
    std::string error;
    EXPECT_TRUE(dynamics->AddLaw(
        MakeMemoryNetwork("device", shape,
                          {Feature::Displacement(0), Feature::Velocity(0)}, 2,
                          MemoryNetwork(shape).DrawWeights(1), 3.0),
        &error))
        << error;
    problem.dynamics = dynamics;
    return ProblemHash(problem);
  };
  EXPECT_EQ(hash_with(0.5), hash_with(0.5));
  EXPECT_NE(hash_with(0.5), hash_with(0.6));
}

TEST(NetworkScales, LeavesWhatWasGivenOrLearned) {
  IdentificationProblem problem = TwoStoreys(Units());
  EXPECT_FALSE(HasNetworksToScale(*problem.dynamics));
  StructuralDynamics dynamics = *problem.dynamics;
  const Vector input = Vector::Constant(4, 3.0);
  std::string error;
  ASSERT_TRUE(dynamics.SetNetworkScales(0, input, Vector(), &error)) << error;
  EXPECT_TRUE(HasNetworksToScale(dynamics));
  ScaleNetworks(problem, &dynamics);
  const NetworkArchitecture& architecture =
      dynamics.networks()[0].network->architecture();
  EXPECT_EQ(architecture.input_scale, input);
  EXPECT_EQ(architecture.output_scale, ArchitectureOf(problem, 0).output_scale);

  NetworkTerm learned = Device(ActsAs::kForce);
  learned.name = learned.weights.name = "learned";
  for (size_t i = 0; i < learned.weights.parameters.size(); ++i) {
    learned.weights.parameters[i].name = "learned" + std::to_string(i);
  }
  learned.drawn = false;
  ASSERT_TRUE(dynamics.AddNetwork(learned, &error)) << error;
  EXPECT_FALSE(HasNetworksToScale(dynamics));
  ScaleNetworks(problem, &dynamics);
  EXPECT_EQ(dynamics.networks()[2].network->architecture().output_scale.size(),
            0);
}

TEST(NetworkScales, WrongOnesAreRefused) {
  StructuralDynamics dynamics = *TwoStoreys(Units()).dynamics;
  const Vector before =
      dynamics.networks()[0].network->architecture().input_scale;
  std::string error;
  EXPECT_FALSE(dynamics.SetNetworkScales(0, Vector::Ones(3), Vector(), &error));
  EXPECT_THAT(error, ::testing::HasSubstr("input_scale has 3 entries"));
  EXPECT_FALSE(dynamics.SetNetworkScales(0, before, Vector::Zero(1), &error));
  EXPECT_THAT(error, ::testing::HasSubstr("output_scale[0] is 0"));
  for (const int network : {-1, 2}) {
    EXPECT_FALSE(dynamics.SetNetworkScales(network, before, Vector(), &error));
    EXPECT_THAT(error, ::testing::HasSubstr("there are 2"));
  }
  EXPECT_EQ(dynamics.networks()[0].network->architecture().input_scale, before);
}

}  // namespace
}  // namespace pinode
