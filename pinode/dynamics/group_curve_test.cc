#include "pinode/dynamics/group_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/dynamics/structural_dynamics.h"
#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Two masses in a row on springs of 10. The first spring depends on the
// temperature: 10 (1 + alpha + change).
StructuralDynamics TwoMassesInFrost(const std::vector<double>& knots,
                                    int reference,
                                    const std::vector<double>& changes) {
  StructuralDynamics dynamics(
      testing::MakeChain(2, 10.0, 0.0),
      {{InputSpec::Kind::kCovariate, 0, "temperature"}});
  GroupTerm group;
  group.group.name = "ground";
  group.group.matrix = 10.0 * SpringMatrix(2, -1, 0);
  group.alpha.value = 0.1;
  std::string error;
  EXPECT_TRUE(dynamics.AddGroup(group, &error)) << error;
  GroupCurve curve;
  curve.name = "ground";
  curve.group = group.group;
  curve.input = 0;
  curve.knots = knots;
  curve.reference = reference;
  curve.parameters.name = "ground.temperature";
  for (const double change : changes) {
    Parameter parameter;
    parameter.name =
        "p" + std::to_string(curve.parameters.parameters.size() + 1);
    parameter.value = change;
    curve.parameters.parameters.push_back(parameter);
  }
  EXPECT_TRUE(dynamics.AddGroupCurve(curve, &error)) << error;
  return dynamics;
}

// Returns the stiffness of the first spring at a temperature.
double StiffnessAt(const StructuralDynamics& dynamics, double temperature) {
  StructuralDynamics::Prepared prepared;
  std::string error;
  EXPECT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
  auto scratch = dynamics.MakeLinearization();
  // Both masses displaced by one: only the spring to the ground resists.
  const Vector state = (Vector(4) << 1.0, 1.0, 0.0, 0.0).finished();
  Vector rate(4);
  dynamics.Rate(prepared, 0.0, &temperature, state.data(), rate.data(),
                &scratch);
  EXPECT_NEAR(rate[3], 0.0, 1e-14);
  return -rate[2];
}

TEST(GroupCurve, IsLinearBetweenKnotsAndConstantBeyond) {
  const StructuralDynamics dynamics =
      TwoMassesInFrost({-20.0, 0.0, 10.0, 30.0}, 2, {0.5, 0.2, -0.1});
  for (const auto& [temperature, change] :
       std::vector<std::pair<double, double>>{{-50.0, 0.5},
                                              {-20.0, 0.5},
                                              {-15.0, 0.425},
                                              {0.0, 0.2},
                                              {2.5, 0.15},
                                              {10.0, 0.0},
                                              {25.0, -0.075},
                                              {30.0, -0.1},
                                              {99.0, -0.1}}) {
    EXPECT_NEAR(StiffnessAt(dynamics, temperature), 10.0 * (1.1 + change),
                1e-12)
        << temperature;
  }
  // Two knots, the reference at either end.
  EXPECT_NEAR(StiffnessAt(TwoMassesInFrost({0.0, 10.0}, 0, {0.4}), 5.0), 13.0,
              1e-12);
  EXPECT_NEAR(StiffnessAt(TwoMassesInFrost({0.0, 10.0}, 1, {0.4}), 5.0), 13.0,
              1e-12);
  EXPECT_NEAR(StiffnessAt(TwoMassesInFrost({0.0, 10.0}, 1, {0.4}), 15.0), 11.0,
              1e-12);
}

// The constant matrices are those at the reference.
TEST(GroupCurve, CorrectedModelIsThatAtTheReference) {
  const StructuralDynamics dynamics =
      TwoMassesInFrost({-20.0, 0.0, 10.0}, 1, {0.5, 0.2});
  EXPECT_NEAR(dynamics.CorrectedModel(dynamics.Parameters()).stiffness(0, 0),
              21.0, 1e-13);
}

// The mean over samples of the curve's values, not the curve at their mean. Its
// parameters are unchanged.
TEST(GroupCurve, AveragedIsConstantAtItsMean) {
  const StructuralDynamics dynamics =
      TwoMassesInFrost({-20.0, 0.0, 10.0, 30.0}, 2, {0.5, 0.2, -0.1});
  const RowVector samples = (RowVector(3) << -20.0, 25.0, 10.0).finished();
  const StructuralDynamics averaged = dynamics.Averaged({samples, {}});
  EXPECT_FALSE(dynamics.IsLinear());
  EXPECT_TRUE(averaged.IsLinear());
  Vector theta = dynamics.Parameters();
  EXPECT_EQ(averaged.Parameters(), theta);
  EXPECT_NEAR(averaged.CorrectedModel(theta).stiffness(0, 0),
              10.0 * (2.1 + (0.5 - 0.075) / 3.0), 1e-12);
  for (const double temperature : {-20.0, 5.0, 90.0}) {
    EXPECT_NEAR(StiffnessAt(averaged, temperature),
                10.0 * (1.1 + (0.5 - 0.075) / 3.0), 1e-12);
  }
  // One at each knot except the reference, a third of the weight of each
  // sample.
  for (const auto& [parameter, slope] : std::vector<std::pair<int, double>>{
           {0, 10.0}, {1, 10.0 / 3.0}, {2, 0.0}, {3, 7.5 / 3.0}}) {
    theta = dynamics.Parameters();
    theta[parameter] += 1.0;
    EXPECT_NEAR(
        averaged.CorrectedModel(theta).stiffness(0, 0) -
            averaged.CorrectedModel(dynamics.Parameters()).stiffness(0, 0),
        slope, 1e-12)
        << parameter;
  }
}

TEST(GroupCurve, AveragedStraightLines) {
  StructuralDynamics dynamics(
      testing::MakeChain(2, 10.0, 0.0),
      {{InputSpec::Kind::kForce, 0, "force_u1"},
       {InputSpec::Kind::kCovariate, 0, "temperature"}});
  std::string error;
  for (const auto follows :
       {GroupTerm::Follows::kCovariate, GroupTerm::Follows::kTime}) {
    GroupTerm group;
    group.group.name =
        follows == GroupTerm::Follows::kTime ? "ageing" : "frost";
    group.group.matrix = 10.0 * SpringMatrix(2, -1, 0);
    group.follows = follows;
    group.input = 1;
    group.reference = 5.0;
    group.alpha.value = 0.1;
    ASSERT_TRUE(dynamics.AddGroup(group, &error)) << error;
  }
  EXPECT_THAT(dynamics.CovariateParameters(), ElementsAre("frost"));
  const Matrix inputs = (Matrix(2, 2) << 100.0, 200.0, 7.0, 11.0).finished();
  const Vector theta = dynamics.Parameters();
  const StructuralDynamics both = dynamics.Averaged({inputs, 2.0});
  EXPECT_TRUE(both.IsLinear());
  EXPECT_NEAR(both.CorrectedModel(theta).stiffness(0, 0),
              20.0 + 10.0 * 0.1 * (9.0 - 5.0) + 10.0 * 0.1 * (2.0 - 5.0),
              1e-12);
  EXPECT_THAT(both.CovariateParameters(), ElementsAre());
  // Without a time the second group still follows it.
  const StructuralDynamics one = dynamics.Averaged({inputs, {}});
  EXPECT_FALSE(one.IsLinear());
  EXPECT_NEAR(one.CorrectedModel(theta).stiffness(0, 0), 24.0, 1e-12);
}

TEST(GroupCurve, ParametersOfGroupsChangeInACopy) {
  StructuralDynamics dynamics =
      TwoMassesInFrost({-20.0, 0.0, 10.0}, 1, {0.5, 0.2});
  std::string error;
  ASSERT_TRUE(dynamics.AddElement("spring", "cubic", 0, 1, {3.0}, &error))
      << error;
  const StructuralDynamics held =
      dynamics.WithGroupParameters([](Parameter* parameter) {
        if (parameter->name[0] != 'p') return;
        parameter->value = parameter->name == "p1" ? 0.7 : 0.8;
        parameter->free = false;
      });
  ASSERT_EQ(held.blocks().size(), dynamics.blocks().size());
  EXPECT_EQ(held.laws().size(), 1u);
  Vector expected = dynamics.Parameters();
  for (size_t b = 0, i = 0; b < held.blocks().size(); ++b) {
    for (const Parameter& parameter : held.blocks()[b].parameters) {
      const bool of_curve = parameter.name[0] == 'p';
      EXPECT_EQ(parameter.free, !of_curve) << parameter.name;
      if (of_curve) {
        expected[static_cast<Eigen::Index>(i)] =
            parameter.name == "p1" ? 0.7 : 0.8;
      }
      ++i;
    }
  }
  EXPECT_EQ(held.Parameters(), expected);
}

// Row times (values at all knots) is the scaled difference that it stands for.
TEST(CurvePrior, HoldsDifferencesOfNeighbours) {
  const std::vector<double> knots = {-10.0, 0.0, 5.0, 20.0};
  const std::vector<double> values = {0.3, 0.1, 0.0, -0.2};
  const Vector parameters = (Vector(3) << 0.3, 0.1, -0.2).finished();
  const double mean = 10.0;
  const CombinationPrior first = CurvePrior(knots, 2, 1, 0.05);
  ASSERT_EQ(first.combinations.size(), 3u);
  std::string error;
  EXPECT_TRUE(first.IsValid(3, 3, &error)) << error;
  EXPECT_FALSE(first.IsValid(3, 2, &error));
  EXPECT_FALSE(first.IsValid(2, 2, &error));
  EXPECT_DOUBLE_EQ(first.precisions[0], 400.0);
  for (size_t k = 0; k < 3; ++k) {
    const auto& row = first.combinations[k];
    EXPECT_NEAR(
        row.weights.dot(parameters.segment(row.first, row.weights.size())),
        (values[k + 1] - values[k]) *
            std::sqrt(mean / (knots[k + 1] - knots[k])),
        1e-14);
  }
  const CombinationPrior second = CurvePrior(knots, 2, 2, 0.0);
  ASSERT_EQ(second.combinations.size(), 2u);
  EXPECT_TRUE(second.IsValid(3, 0, &error)) << error;
  EXPECT_LT(second.precisions[0], 0.0);
  for (size_t k = 0; k < 2; ++k) {
    const auto& row = second.combinations[k];
    const double before = knots[k + 1] - knots[k];
    const double behind = knots[k + 2] - knots[k + 1];
    const double kink = (values[k + 2] - values[k + 1]) / behind -
                        (values[k + 1] - values[k]) / before;
    EXPECT_NEAR(
        row.weights.dot(parameters.segment(row.first, row.weights.size())),
        kink * mean * std::sqrt(mean / (0.5 * (before + behind))), 1e-14);
  }
}

TEST(GroupCurve, RefusesWhatDoesNotFit) {
  const StructuralDynamics good =
      TwoMassesInFrost({-20.0, 0.0, 10.0}, 1, {0.5, 0.2});
  const auto error_with = [&good](const auto& change) {
    StructuralDynamics dynamics(good.model(), good.inputs());
    std::string error;
    EXPECT_TRUE(dynamics.AddGroup(good.groups()[0], &error));
    GroupCurve curve = good.group_curves()[0];
    change(&curve);
    EXPECT_FALSE(dynamics.AddGroupCurve(curve, &error));
    EXPECT_EQ(dynamics.num_parameters(), 1);
    return error;
  };
  EXPECT_THAT(error_with([](GroupCurve* c) { c->name = "other"; }),
              HasSubstr("a group of that name"));
  EXPECT_THAT(error_with([](GroupCurve* c) { c->input = 1; }),
              HasSubstr("unknown covariate"));
  EXPECT_THAT(error_with([](GroupCurve* c) { c->knots[2] = 0.0; }),
              HasSubstr("do not ascend"));
  EXPECT_THAT(error_with([](GroupCurve* c) { c->knots[2] = std::nan(""); }),
              HasSubstr("do not ascend"));
  EXPECT_THAT(error_with([](GroupCurve* c) { c->reference = 3; }),
              HasSubstr("one of them the reference"));
  EXPECT_THAT(error_with([](GroupCurve* c) { c->knots.push_back(11.0); }),
              HasSubstr("a parameter for each other"));
  EXPECT_THAT(error_with([](GroupCurve* c) {
                c->group.target = MatrixGroup::Target::kMass;
              }),
              HasSubstr("a mass cannot follow"));
  EXPECT_THAT(error_with([](GroupCurve* c) {
                c->prior = CurvePrior({0.0, 1.0, 2.0, 3.0}, 0, 1, 1.0);
              }),
              HasSubstr("prior does not fit"));
  EXPECT_THAT(error_with([](GroupCurve* c) {
                c->prior = CurvePrior(c->knots, c->reference, 1, 1.0);
                c->parameters.parameters[0].free = false;
              }),
              HasSubstr("free, or none"));
}

}  // namespace
}  // namespace pinode
