#include "pinode/discover/discovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/dynamics/memory_network.h"
#include "pinode/network/network.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

// Two masses in free vibration from [1, -0.5, 0, 0.3] with one network of all
// displacements and velocities on the first of them.
class DiscoverFromNetwork : public ::testing::Test {
 protected:
  void MakeModel(const NetworkArchitecture& architecture,
                 const Vector& weights) {
    Matrix stiffness(2, 2);
    stiffness << 20.0, -10.0, -10.0, 10.0;
    StructuralModel model = MakeStructuralModel(Matrix::Identity(2, 2),
                                                0.02 * stiffness, stiffness);
    auto dynamics = std::make_shared<StructuralDynamics>(
        std::move(model), std::vector<InputSpec>());
    NetworkTerm term;
    term.name = "nn";
    term.network = std::make_shared<Network>(architecture);
    term.features = {Feature::Displacement(0), Feature::Displacement(1),
                     Feature::Velocity(0), Feature::Velocity(1)};
    term.outputs = Matrix::Identity(2, 1);
    term.output_names = {"u1"};
    term.weights.name = "nn";
    term.weights.named = false;
    term.weights.parameters.resize(static_cast<size_t>(weights.size()));
    for (int i = 0; i < weights.size(); ++i) {
      Parameter& parameter = term.weights.parameters[static_cast<size_t>(i)];
      parameter.name = "nn[" + std::to_string(i) + "]";
      parameter.value = weights[i];
    }
    std::string error;
    ASSERT_TRUE(dynamics->AddNetwork(std::move(term), &error)) << error;
    problem_.dynamics = dynamics;
    IdentificationRecord record;
    record.name = "free";
    record.excitation.emplace(0.0, 0.05, Matrix(0, 121),
                              Interpolation::kLinear);
    record.substeps = 2;
    problem_.records = {record};
    model_.parameters = ParameterLayout(problem_).InitialValues();
    Vector start(4);
    start << 1.0, -0.5, 0.0, 0.3;
    model_.starts = {start};
  }

  // A linear network, y = -3 x1 + 1.5 x2 - 0.2 v1.
  void MakeLinear() {
    NetworkArchitecture architecture;
    architecture.num_inputs = 4;
    architecture.num_outputs = 1;
    architecture.bias = false;
    Vector weights(4);
    weights << -3.0, 1.5, -0.2, 0.0;
    MakeModel(architecture, weights);
  }

  void MakeGauged() {
    NetworkArchitecture architecture;
    architecture.num_inputs = 4;
    architecture.num_outputs = 1;
    architecture.hidden_widths = {2};
    architecture.skip = false;
    architecture.gauge = true;
    const int count = architecture.NumWeights();
    Vector weights(count);
    for (int i = 0; i < count; ++i) weights[i] = std::sin(1.7 * i + 0.3);
    MakeModel(architecture, weights);
  }

  IdentificationProblem problem_;
  IdentifiedModel model_;
  DiscoveryOptions options_;
  std::vector<DiscoveredEquation> equations_;
  std::string error_;
};

std::vector<std::string> Bases(const DiscoveredEquation& equation) {
  std::vector<std::string> bases;
  for (const DiscoveredTerm& term : equation.terms) bases.push_back(term.basis);
  return bases;
}

TEST_F(DiscoverFromNetwork, TheLinearPathIsPartOfTheEquation) {
  MakeLinear();
  for (const auto solver :
       {DiscoveryOptions::Solver::kLasso, DiscoveryOptions::Solver::kStlsq}) {
    options_.solver = solver;
    ASSERT_TRUE(
        DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_))
        << error_;
    ASSERT_EQ(equations_.size(), 1u);
    const DiscoveredEquation& equation = equations_[0];
    EXPECT_EQ(equation.output, "u1");
    EXPECT_EQ(equation.num_candidates, 34);  // degree 3 in 4 features
    EXPECT_THAT(Bases(equation),
                UnorderedElementsAre("x[u1]", "x[u2]", "v[u1]"));
    for (const DiscoveredTerm& term : equation.terms) {
      const double truth = term.basis == "x[u1]"   ? -3.0
                           : term.basis == "x[u2]" ? 1.5
                                                   : -0.2;
      EXPECT_NEAR(term.coefficient, truth, 1e-9);
      EXPECT_NEAR(term.share, std::abs(truth) * term.basis_rms / equation.scale,
                  1e-9);
    }
    EXPECT_GE(equation.terms[0].share, equation.terms[1].share);
    EXPECT_LT(equation.residual, 1e-9);
    EXPECT_EQ(equation.pareto.front().num_terms, 0);
    EXPECT_NEAR(equation.pareto.front().residual, equation.output_rms, 1e-12);
  }
}

// A contribution below the tolerance is not worth a term.
TEST_F(DiscoverFromNetwork, ToleranceIsAShareOfTheAcceleration) {
  MakeLinear();
  ASSERT_TRUE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_))
      << error_;
  // The library holds the truth, so that what is lost is what is left.
  const std::vector<DiscoveryParetoPoint> pareto = equations_[0].pareto;
  ASSERT_GE(pareto.size(), 4u);
  for (int terms = 0; terms < 3; ++terms) {
    const DiscoveryParetoPoint& point = pareto[static_cast<size_t>(terms)];
    ASSERT_EQ(point.num_terms, terms);
    for (const double factor : {0.999, 1.001}) {
      options_.tolerance = factor * point.residual;
      ASSERT_TRUE(DiscoverFromNetworks(problem_, model_, options_, &equations_,
                                       &error_))
          << error_;
      const int expected = factor > 1.0 ? terms : terms + 1;
      EXPECT_EQ(static_cast<int>(equations_[0].terms.size()), expected);
    }
  }
}

TEST_F(DiscoverFromNetwork, RelativeDisplacementsAndConditions) {
  MakeLinear();
  options_.features = {Feature::Displacement(0), Feature::Deformation(0, 1),
                       Feature::Velocity(0)};
  options_.library.polynomial_degree = 1;
  DiscoveryOptions::Output output;
  output.name = "u1";
  output.library = options_.library;
  output.constraints = {CoefficientConstraint::Given("v[u1]", -0.2),
                        CoefficientConstraint::Negative("x[u1]")};
  options_.outputs = {output};
  ASSERT_TRUE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_))
      << error_;
  // -3 x1 + 1.5 x2 = -1.5 x1 + 1.5 (x2 - x1).
  for (const DiscoveredTerm& term : equations_[0].terms) {
    const double truth = term.basis == "x[u1]"      ? -1.5
                         : term.basis == "d[u1,u2]" ? 1.5
                                                    : -0.2;
    EXPECT_NEAR(term.coefficient, truth, 1e-9) << term.basis;
    EXPECT_EQ(term.given, term.basis == "v[u1]");
    EXPECT_EQ(term.sign, term.basis == "x[u1]" ? -1 : 0);
  }
  EXPECT_EQ(equations_[0].terms.size(), 3u);
}

TEST_F(DiscoverFromNetwork, InclusionProbabilitiesOfAnEnsemble) {
  MakeLinear();
  options_.num_bags = 8;
  ASSERT_TRUE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_))
      << error_;
  for (const DiscoveredTerm& term : equations_[0].terms) {
    EXPECT_EQ(term.inclusion_probability, 1.0) << term.basis;
  }
}

TEST_F(DiscoverFromNetwork, AGaugedNetworkHasNoSlopeAtRest) {
  MakeGauged();
  ASSERT_TRUE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_))
      << error_;
  EXPECT_EQ(equations_[0].num_candidates, 30);
  for (const std::string& basis : Bases(equations_[0])) {
    EXPECT_THAT(basis, ::testing::AnyOf(HasSubstr("^"), HasSubstr("*")));
  }
  options_.library.polynomial_degree = 1;
  EXPECT_FALSE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_));
  EXPECT_THAT(error_, HasSubstr("no slope at rest"));
}

TEST_F(DiscoverFromNetwork, RefusesWhatCannotBe) {
  MakeLinear();
  options_.library.sine_features = {"x[u7]"};
  EXPECT_FALSE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_));
  EXPECT_THAT(error_, HasSubstr("x[u7]"));
  options_ = DiscoveryOptions();
  options_.tolerance = 0.0;
  EXPECT_FALSE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_));
  EXPECT_THAT(error_, HasSubstr("tolerance"));
  options_ = DiscoveryOptions();
  options_.outputs.resize(1);
  options_.outputs[0].name = "u2";
  EXPECT_FALSE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_));
  EXPECT_THAT(error_, HasSubstr("'u2'"));
  options_ = DiscoveryOptions();
  // A spring that pushes: it runs away.
  model_.parameters[0] = 1e5;
  EXPECT_FALSE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_));
  EXPECT_THAT(error_, HasSubstr("not finite"));
  auto dynamics = std::make_shared<StructuralDynamics>(
      problem_.dynamics->model(), std::vector<InputSpec>());
  const MemoryNetworkShape shape;
  ASSERT_TRUE(dynamics->AddLaw(
      MakeMemoryNetwork("device", shape,
                        {Feature::Displacement(0), Feature::Velocity(0)}, 2,
                        MemoryNetwork(shape).DrawWeights(1), 3.0),
      &error_));
  problem_.dynamics = dynamics;
  EXPECT_FALSE(
      DiscoverFromNetworks(problem_, model_, options_, &equations_, &error_));
  EXPECT_THAT(error_, HasSubstr("'device' is a network with memory"));
}

}  // namespace
}  // namespace pinode
