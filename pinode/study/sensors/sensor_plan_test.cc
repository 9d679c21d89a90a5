#include "pinode/study/sensors/sensor_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using Criterion = SensorPlanOptions::Criterion;

std::vector<CandidateSensor> EverySensor(int num_dofs, Quantity quantity,
                                         double sigma) {
  std::vector<CandidateSensor> sensors;
  for (int dof = 0; dof < num_dofs; ++dof) {
    CandidateSensor sensor;
    sensor.observation.name =
        std::string(QuantityName(quantity)) + std::to_string(dof + 1);
    sensor.observation.quantity = quantity;
    sensor.observation.weights = Vector::Unit(num_dofs, dof);
    sensor.sigma = sigma;
    sensors.push_back(std::move(sensor));
  }
  return sensors;
}

SensorPlan PlanOrFail(const IdentificationProblem& problem,
                      const std::vector<CandidateSensor>& candidates,
                      const SensorPlanOptions& options) {
  SensorPlan plan;
  std::string error;
  EXPECT_TRUE(PlanSensors(problem, IdentificationOptions(), OwnSensors(problem),
                          candidates, options, &plan, &error))
      << error;
  return plan;
}

// So slow a ground motion that masses follow it: u_i = -a sum_{j <= i} F_j/k_j,
// F_j the masses from floor j up.
IdentificationProblem SlowChain(int n, double* squares) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(n, 100.0, 0.5);
  constexpr int kSamples = 2001;
  Matrix ground(1, kSamples);
  *squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double phase = M_PI * i / (kSamples - 1);
    // Smooth from rest.
    ground(0, i) = std::pow(std::sin(phase), 4.0);
    *squares += ground(0, i) * ground(0, i);
  }
  IdentificationRecord record;
  record.name = "slow";
  record.excitation.emplace(0.0, 0.5, ground, Interpolation::kLinear);
  record.start = IdentificationRecord::Start::kRest;
  problem.records.push_back(std::move(record));
  ChooseStepsOrFail(&problem);
  return problem;
}

TEST(SensorPlanTest, BestSensorOfASlowChain) {
  double squares = 0.0;
  const IdentificationProblem problem = SlowChain(3, &squares);
  const Vector masses = problem.dynamics->model().mass.diagonal();
  const std::vector<CandidateSensor> floors =
      EverySensor(3, Quantity::kDisplacement, 1e-3);
  // With the factor of storey j floor i >= j moves F_j / k more. A sensor above
  // determines all storeys below it, one below determines none.
  SensorPlanOptions options;
  const SensorPlan plan = PlanOrFail(problem, floors, options);
  EXPECT_EQ(plan.targets, (std::vector<std::string>{"k1", "k2", "k3"}));
  ASSERT_EQ(plan.steps.size(), 1u);
  EXPECT_EQ(plan.steps[0].candidate, 2);
  Vector slopes(3);
  for (int j = 0; j < 3; ++j) slopes[j] = masses.tail(3 - j).sum() / 100.0;
  for (int floor = 0; floor < 3; ++floor) {
    Vector seen = slopes;
    seen.tail(2 - floor).setZero();
    const Matrix expected = squares / 1e-6 * seen * seen.transpose();
    EXPECT_LT(
        (plan.information.candidates[static_cast<size_t>(floor)].by_record[0] -
         expected)
            .norm(),
        0.01 * expected.norm());
  }
  // One sensor sees one combination of the three; each of three sees its own.
  EXPECT_EQ(plan.undetermined_by_plan.size(), 2u);
  options.num_sensors = 3;
  const SensorPlan all = PlanOrFail(problem, floors, options);
  EXPECT_TRUE(all.undetermined_by_plan.empty());
  ASSERT_EQ(all.by_plan.size(), 3u);
  // The differences of neighbouring floors tell a storey: 1, 2 and 2 sensors.
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(all.by_plan[static_cast<size_t>(j)].sigma,
                1e-3 * std::sqrt((j == 0 ? 1.0 : 2.0) / squares) / slopes[j],
                0.02 * all.by_plan[static_cast<size_t>(j)].sigma);
  }
  EXPECT_EQ(all.next.candidate, -1);

  // For the first storey alone with the others unknown: the floor above it.
  options.num_sensors = 1;
  options.targets = {"k1"};
  EXPECT_EQ(PlanOrFail(problem, floors, options).steps[0].candidate, 0);
}

// Typical and worst deviation of a set, the plain way.
struct PlainValue {
  double typical = 0.0;
  double worst = 0.0;
};
PlainValue ValueOf(const PlanningInformation& information,
                   const std::vector<int>& chosen,
                   const std::vector<int>& targets) {
  Matrix sum = information.known;
  for (const int i : chosen) {
    sum += information.candidates[static_cast<size_t>(i)].by_record[0];
  }
  for (const int j : targets) sum(j, j) += 0.01;
  const Matrix inverse = sum.inverse();
  const auto count = static_cast<Eigen::Index>(targets.size());
  Matrix block(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index k = 0; k < count; ++k) {
      block(i, k) = inverse(targets[static_cast<size_t>(i)],
                            targets[static_cast<size_t>(k)]);
    }
  }
  return {std::pow(block.determinant(), 0.5 / static_cast<double>(count)),
          std::sqrt(block.diagonal().maxCoeff())};
}

// All triples of ten sensors: the choice is within 2 % of the best (the mean
// axis of the region, or the worst deviation).
TEST(SensorPlanTest, AgreesWithExhaustiveSearch) {
  IdentificationProblem problem =
      MeasuredChain(5, *ChainAt(Vector::Zero(5)), 1);
  std::vector<CandidateSensor> sensors =
      EverySensor(5, Quantity::kAbsoluteAcceleration, 0.02);
  for (CandidateSensor& sensor :
       EverySensor(5, Quantity::kDisplacement, 0.002)) {
    sensors.push_back(std::move(sensor));
  }
  for (const Criterion criterion :
       {Criterion::kDeterminant, Criterion::kWorstDeviation}) {
    SensorPlanOptions options;
    options.num_sensors = 3;
    options.criterion = criterion;
    options.targets = {"k1", "k2", "k4", "k5"};
    const SensorPlan plan = PlanOrFail(problem, sensors, options);
    const std::vector<int> targets = {0, 1, 3, 4};
    PlainValue best = {1e9, 1e9};
    for (int a = 0; a < 10; ++a) {
      for (int b = 0; b < a; ++b) {
        for (int c = 0; c < b; ++c) {
          const PlainValue value =
              ValueOf(plan.information, {a, b, c}, targets);
          best.typical = std::min(best.typical, value.typical);
          best.worst = std::min(best.worst, value.worst);
        }
      }
    }
    std::vector<int> chosen;
    for (const SensorPlan::Step& step : plan.steps) {
      chosen.push_back(step.candidate);
      const PlainValue value = ValueOf(plan.information, chosen, targets);
      EXPECT_NEAR(step.typical, value.typical, 1e-5 * value.typical);
      EXPECT_NEAR(step.worst, value.worst, 1e-5 * value.worst);
    }
    const PlainValue reached = ValueOf(plan.information, chosen, targets);
    if (criterion == Criterion::kDeterminant) {
      EXPECT_LE(reached.typical, 1.02 * best.typical);
    } else {
      EXPECT_LE(reached.worst, 1.02 * best.worst);
    }
    // One more sensor would be no worse.
    EXPECT_LE(plan.next.typical, plan.steps.back().typical);
  }
}

TEST(SensorPlanTest, OwnSensorsMayStay) {
  IdentificationProblem problem =
      MeasuredChain(4, *ChainAt(Vector::Zero(4)), 1);
  problem.records[0].channels.resize(1);
  problem.records[0].channels[0].sigma = 0.02;
  const std::vector<CandidateSensor> sensors =
      EverySensor(4, Quantity::kAbsoluteAcceleration, 0.02);
  SensorPlanOptions options;
  options.num_sensors = 2;
  const SensorPlan alone = PlanOrFail(problem, sensors, options);
  options.keep_own = true;
  const SensorPlan more = PlanOrFail(problem, sensors, options);
  EXPECT_NEAR(alone.without.typical, 10.0, 1e-12);
  EXPECT_DOUBLE_EQ(more.without.typical, alone.own.typical);
  EXPECT_LT(more.steps[1].typical, alone.steps[1].typical);
}

TEST(SensorPlanTest, LongerRecordsTellMore) {
  const IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  const std::vector<CandidateSensor> sensors =
      EverySensor(3, Quantity::kAbsoluteAcceleration, 0.0);
  SensorPlanOptions options;
  options.num_sensors = 2;
  const SensorPlan plan = PlanOrFail(problem, sensors, options);
  std::vector<PlannedDuration> reached;
  std::string error;
  const double whole = 0.05 * 399;
  ASSERT_TRUE(PlanDurations(problem, IdentificationOptions(),
                            OwnSensors(problem), sensors, options, plan,
                            {whole / 4.0, whole}, &reached, &error))
      << error;
  ASSERT_EQ(reached.size(), 2u);
  EXPECT_NEAR(reached[1].reached.typical, plan.steps.back().typical,
              1e-9 * plan.steps.back().typical);
  EXPECT_GT(reached[0].reached.typical, 1.5 * reached[1].reached.typical);
  EXPECT_FALSE(PlanDurations(problem, IdentificationOptions(), {}, sensors,
                             options, plan, {2.0 * whole}, &reached, &error));
  EXPECT_NE(error.find("duration"), std::string::npos);
}

TEST(SensorPlanTest, RefusesWhatCannotBePlanned) {
  const IdentificationProblem problem =
      MeasuredChain(2, *ChainAt(Vector::Zero(2)), 1);
  const std::vector<CandidateSensor> sensors =
      EverySensor(2, Quantity::kVelocity, 0.1);
  SensorPlan plan;
  std::string error;
  SensorPlanOptions options;
  options.num_sensors = 3;
  EXPECT_FALSE(PlanSensors(problem, IdentificationOptions(), {}, sensors,
                           options, &plan, &error));
  EXPECT_NE(error.find("expected 1 to 2"), std::string::npos) << error;
  options.num_sensors = 1;
  options.targets = {"k3"};
  EXPECT_FALSE(PlanSensors(problem, IdentificationOptions(), {}, sensors,
                           options, &plan, &error));
  EXPECT_NE(error.find("'k3'"), std::string::npos) << error;
}

}  // namespace
}  // namespace pinode
