#include "pinode/estimate/fit/multistart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "pinode/dynamics/memory_network.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

TEST(Multistart, DrawsWithinBoundsAndPriors) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  const Vector initial = fit.layout->InitialValues();
  const Vector one = DrawStart(fit.problem, *fit.layout, MultistartTuning(), 1);
  EXPECT_EQ(one, DrawStart(fit.problem, *fit.layout, MultistartTuning(), 1));
  const Vector two = DrawStart(fit.problem, *fit.layout, MultistartTuning(), 2);
  int drawn = 0;
  for (int i = 0; i < fit.layout->num_parameters(); ++i) {
    const Parameter& parameter = fit.layout->parameter(i);
    if (fit.layout->FreeIndex(i) < 0) {
      EXPECT_EQ(one[i], initial[i]) << parameter.name;
      continue;
    }
    EXPECT_GE(one[i], parameter.lower);
    EXPECT_LE(one[i], parameter.upper);
    drawn += one[i] != two[i] ? 1 : 0;
    if (parameter.HasPrior()) {
      EXPECT_NEAR(one[i], parameter.prior_mean, 2.0 * parameter.prior_sigma);
    }
  }
  EXPECT_GT(drawn, 5);
}

// As most cases have their groups.
TEST(Multistart, DrawsGroupsWithoutBoundsAroundTheirNominalSize) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  IdentificationProblem problem = fit.problem;
  auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
  GroupTerm group;
  group.group.name = "loose";
  group.group.target = MatrixGroup::Target::kStiffness;
  group.group.matrix =
      Matrix::Identity(dynamics->num_dofs(), dynamics->num_dofs());
  group.alpha.free = true;
  group.present = 1.2;
  std::string error;
  ASSERT_TRUE(dynamics->AddGroup(group, &error)) << error;
  problem.dynamics = dynamics;
  const ParameterLayout layout(problem);
  double least = 2.0, most = 0.5;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const Vector start = DrawStart(problem, layout, MultistartTuning(), seed);
    for (int i = 0; i < layout.num_parameters(); ++i) {
      if (layout.parameter(i).name != "loose") continue;
      least = std::min(least, 1.2 + start[i]);
      most = std::max(most, 1.2 + start[i]);
    }
  }
  EXPECT_NEAR(least, 0.5, 0.05);
  EXPECT_NEAR(most, 2.0, 0.1);
}

// All starts had the same weights otherwise.
TEST(Multistart, DrawsTheWeightsOfNetworksWithMemory) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  IdentificationProblem problem = fit.problem;
  const ParameterLayout plain(problem);
  auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
  const MemoryNetworkShape shape;
  const Vector weights = MemoryNetwork(shape).DrawWeights(1);
  LawTerm device = MakeMemoryNetwork(
      "device", shape, {Feature::Displacement(0), Feature::Velocity(0)},
      dynamics->num_dofs(), weights, 3.0);
  device.parameters.parameters[0].free = false;
  std::string error;
  ASSERT_TRUE(dynamics->AddLaw(std::move(device), &error)) << error;
  problem.dynamics = dynamics;
  const ParameterLayout layout(problem);
  const auto weights_of = [&](std::uint64_t seed) {
    const Vector start = DrawStart(problem, layout, MultistartTuning(), seed);
    for (int i = 0; i < layout.num_parameters(); ++i) {
      if (layout.parameter(i).name == "device[0]") {
        return Vector(start.segment(i, weights.size()));
      }
    }
    return Vector();
  };
  ASSERT_EQ(weights_of(3).size(), weights.size());
  EXPECT_EQ(weights_of(3), weights_of(3));
  EXPECT_EQ(weights_of(3)[0], weights[0]) << "it is fixed";
  EXPECT_GT((weights_of(3) - weights).norm(), 0.5);
  EXPECT_GT((weights_of(3) - weights_of(4)).norm(), 0.5);
  // Other draws stay as they are without it.
  const Vector with = DrawStart(problem, layout, MultistartTuning(), 5);
  const Vector without = DrawStart(fit.problem, plain, MultistartTuning(), 5);
  EXPECT_EQ(with[0], without[0]);
}

// A chain whose storeys are far from the start, fitted with one step a stage:
// no start gets anywhere.
TEST(Multistart, TriesOtherStartsWhereTheFirstIsLost) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(3, 100.0, 0.05);
  IdentificationRecord record =
      testing::MakeExcitedRecord(*problem.dynamics, 400, 0.05);
  record.start = IdentificationRecord::Start::kRest;
  for (int i = 0; i < 3; ++i) {
    record.channels.push_back(testing::MakeChannel(
        "a" + std::to_string(i + 1), Quantity::kAbsoluteAcceleration, 3, i));
  }
  record.substeps = 8;
  const auto truth = testing::MakeGroupedChain(3, 100.0, 0.05);
  truth->SetParameters(Vector{{1.5, -0.6, 0.9}});
  testing::Simulate(*truth, truth->Parameters(), Vector::Zero(6), 0.001, 1,
                    &record);
  problem.records.push_back(std::move(record));
  IdentificationOptions options;
  options.max_num_iterations = 1;
  const auto starts = [&]() {
    FitSummary summary;
    const std::unique_ptr<Fit> fit =
        RunStarts(problem, options, nullptr, &summary);
    EXPECT_NE(fit, nullptr);
    return summary.num_starts;
  };
  const int of_lost = starts();
  EXPECT_GT(of_lost, 1);
  EXPECT_LE(of_lost, kStartsOfLost);
  options.num_starts = 1;
  EXPECT_EQ(starts(), 1);
  // A fit that gets there needs no other start.
  options.num_starts = 0;
  options.max_num_iterations = 100;
  problem.dynamics = truth;
  EXPECT_EQ(starts(), 1);
}

}  // namespace
}  // namespace pinode
