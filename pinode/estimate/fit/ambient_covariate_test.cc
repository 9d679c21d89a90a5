// Ambient records of structures that follow the temperature.

#include <cmath>
#include <memory>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "tests/support/ambient_covariate_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

void ExpectFound(const ParameterEstimate& found, double truth, double least) {
  EXPECT_NEAR(found.value, truth, 3.5 * found.sigma) << found.name;
  EXPECT_LT(found.sigma, least) << found.name;
}

TEST(AmbientCovariateTest, GradientIsThatOfTheCost) {
  ExpectGradientOfCost(ProblemOfRecords(0.002, {RecordAt(10.0, 1, 300.0)}));
  AmbientRecord drifting = RecordAt(10.0, 1, 300.0);
  SetTemperature(Vector::LinSpaced(drifting.samples.cols(), 4.0, 16.0),
                 &drifting);
  ExpectGradientOfCost(
      ProblemOfRecords(0.002, {drifting}, {0.0, 8.0, kReference}));
}

// A slope of alpha at a distance from the reference is an alpha.
TEST(AmbientCovariateTest, CostIsThatOfTheMeanStiffness) {
  AmbientRecord record = RecordAt(10.0, 2, 200.0);
  SetTemperature(Vector::LinSpaced(record.samples.cols(), 5.0, 15.0), &record);
  const auto cost_of = [](const IdentificationProblem& problem,
                          const Vector& free) {
    const ParameterLayout layout(problem);
    AmbientCost cost(problem.ambient[0], *problem.dynamics, layout, 1);
    double value = 0.0;
    EXPECT_TRUE(cost.Evaluate(free, &value)) << cost.Failure();
    return value;
  };
  const IdentificationProblem follows = ProblemOfRecords(0.0, {record});
  const double shift = kSlope * (10.0 - kReference);
  AmbientRecord plain = record;
  plain.inputs.reset();
  const IdentificationProblem constant = ProblemOfChain(
      TestChain(2, kChainSpring), kChainSpring, 0.0, std::move(plain));
  const Vector by_slope =
      (Vector(5) << 0.01, -0.02, 0.9, 0.8, kSlope).finished();
  const Vector by_alpha =
      (Vector(4) << 0.01 + shift, -0.02 + shift, 0.9, 0.8).finished();
  const double expected = cost_of(constant, by_alpha);
  EXPECT_NEAR(cost_of(follows, by_slope), expected, 1e-6 * expected);
}

TEST(AmbientCovariateTest, FindsTheSlopeFromRecordsOfSeveralTemperatures) {
  const IdentificationProblem problem =
      ProblemOfRecords(0.05, {RecordAt(-5.0, 1, 400.0), RecordAt(8.0, 2, 400.0),
                              RecordAt(25.0, 3, 400.0)});
  const IdentificationSummary summary = SummaryOfFit(problem);
  ASSERT_TRUE(summary.usable()) << summary.message;
  ASSERT_EQ(summary.parameters.size(), 5u);
  ExpectFound(summary.parameters[0], 0.0, 0.01);
  ExpectFound(summary.parameters[1], 0.0, 0.01);
  ExpectFound(summary.parameters[4], kSlope, 4e-4);
}

TEST(AmbientCovariateTest, FindsATable) {
  const IdentificationProblem problem =
      ProblemOfRecords(0.05,
                       {RecordAt(0.0, 1, 400.0), RecordAt(10.0, 2, 400.0),
                        RecordAt(20.0, 3, 400.0)},
                       {0.0, 10.0, kReference});
  const IdentificationSummary summary = SummaryOfFit(problem);
  ASSERT_TRUE(summary.usable()) << summary.message;
  ASSERT_EQ(summary.parameters.size(), 7u);
  ExpectFound(summary.parameters[5], -20.0 * kSlope, 0.02);
  ExpectFound(summary.parameters[6], -10.0 * kSlope, 0.02);
}

// One temperature alone does not tell a slope from what does not follow it.
TEST(AmbientCovariateTest, OneTemperatureIsNotEnough) {
  const IdentificationProblem problem =
      ProblemOfRecords(0.05, {RecordAt(8.0, 2, 400.0)});
  const IdentificationSummary summary = SummaryOfFit(problem);
  ASSERT_EQ(summary.undetermined.size(), 1u);
  for (const char* name : {"k1", "k2", "all"}) {
    EXPECT_THAT(summary.undetermined[0], HasSubstr(name));
  }
  EXPECT_GT(summary.parameters[4].sigma, 0.1);
}

// A dashpot that grows as it gets colder: what it does at the record's
// temperature, not at the reference, is the damping that was found.
TEST(AmbientCovariateTest, DampingIsThatOfTheRecord) {
  IdentificationProblem problem =
      ProblemOfRecords(0.05, {RecordAt(10.0, 2, 300.0)});
  auto dynamics = std::make_shared<StructuralDynamics>(
      problem.dynamics->model(), problem.dynamics->inputs());
  std::string error;
  for (GroupTerm term : problem.dynamics->groups()) {
    if (term.group.name == "all") {
      // As much again as the chain has, at 10 degrees.
      term.group = problem.dynamics->groups()[2].group;
      term.group.name = "all";
      term.alpha.value = -0.1;
      term.alpha.free = false;
    }
    ASSERT_TRUE(dynamics->AddGroup(term, &error)) << error;
  }
  problem.dynamics = dynamics;
  const IdentificationSummary summary = SummaryOfFit(problem);
  ASSERT_TRUE(summary.usable()) << summary.message;
  // The group itself has no stiffness there, and none is left at 20 degrees.
  EXPECT_LT(summary.parameters[2].value, 0.5);
  EXPECT_NEAR(summary.final_damping, 0.01, 0.003);
}

// Gaps have no part in the mean.
TEST(AmbientCovariateTest, MeanIsThatOfWhatWasRecorded) {
  AmbientRecord record = RecordAt(10.0, 2, 100.0);
  const Eigen::Index half = record.samples.cols() / 2;
  Vector temperature = Vector::Constant(record.samples.cols(), 10.0);
  temperature.tail(record.samples.cols() - half).setConstant(30.0);
  SetTemperature(temperature, &record);
  record.samples.row(0)
      .tail(record.samples.cols() - half)
      .setConstant(std::nan(""));
  const IdentificationProblem problem = ProblemOfRecords(0.0, {record});
  Vector theta = problem.dynamics->Parameters();
  theta[4] = kSlope;
  EXPECT_NEAR(record.AveragedDynamics(*problem.dynamics)
                  .CorrectedModel(theta)
                  .stiffness(1, 1),
              SpringAt(10.0), 1e-9);
}

TEST(AmbientCovariateTest, RefusesARecordWithoutTemperature) {
  IdentificationProblem problem =
      ProblemOfRecords(0.05, {RecordAt(8.0, 2, 200.0)});
  problem.ambient[0].inputs.reset();
  std::string error;
  EXPECT_FALSE(problem.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("follows a covariate"));
}

}  // namespace
}  // namespace pinode
