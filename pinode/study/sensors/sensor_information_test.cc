#include "pinode/study/sensors/sensor_information.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/estimate/certainty/assessment.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/study/sensors/sensor_plan.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

CandidateSensor SensorAt(Quantity quantity, int num_dofs, int dof,
                         double sigma) {
  CandidateSensor sensor;
  sensor.observation.name =
      std::string(QuantityName(quantity)) + std::to_string(dof + 1);
  sensor.observation.quantity = quantity;
  sensor.observation.weights = Vector::Unit(num_dofs, dof);
  sensor.sigma = sigma;
  return sensor;
}

PlanningInformation LinearizeOrFail(
    const IdentificationProblem& problem, const std::vector<OwnSensor>& own,
    const std::vector<CandidateSensor>& candidates) {
  PlanningInformation information;
  std::string error;
  EXPECT_TRUE(LinearizeSensors(problem, IdentificationOptions(), own,
                               candidates, &information, &error))
      << error;
  return information;
}

// With its own sensors a plan says what pinode_check says.
void ExpectAsAssessed(const IdentificationProblem& problem, double tolerance) {
  ProblemAssessment assessment;
  SensorPlan plan;
  std::string error;
  const int n = problem.dynamics->num_dofs();
  ASSERT_TRUE(
      AssessProblem(problem, IdentificationOptions(), &assessment, &error))
      << error;
  ASSERT_TRUE(PlanSensors(problem, IdentificationOptions(), OwnSensors(problem),
                          {SensorAt(Quantity::kDisplacement, n, 0, 1.0)}, {},
                          &plan, &error))
      << error;
  ASSERT_EQ(plan.by_own.size(), assessment.expected.size());
  for (size_t j = 0; j < plan.by_own.size(); ++j) {
    EXPECT_EQ(plan.by_own[j].name, assessment.expected[j].name);
    EXPECT_NEAR(plan.by_own[j].sigma, assessment.expected[j].sigma,
                tolerance * assessment.expected[j].sigma);
  }
}

TEST(SensorInformationTest, OwnSensorsTellWhatIsAssessed) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  for (MeasuredChannel& channel : problem.records[0].channels) {
    channel.sigma = 0.02;
  }
  ExpectAsAssessed(problem, 1e-8);
}

TEST(SensorInformationTest, UnknownStartsAreEliminated) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  for (MeasuredChannel& channel : problem.records[0].channels) {
    channel.sigma = 0.02;
  }
  const std::vector<CandidateSensor> sensors = {
      SensorAt(Quantity::kAbsoluteAcceleration, 3, 0, 0.02),
      SensorAt(Quantity::kAbsoluteAcceleration, 3, 2, 0.02)};
  const PlanningInformation known = LinearizeOrFail(problem, {}, sensors);
  problem.records[0].start = IdentificationRecord::Start::kFree;
  // The smoother finds the start that made the record within its noise.
  ExpectAsAssessed(problem, 0.02);

  const PlanningInformation unknown = LinearizeOrFail(problem, {}, sensors);
  ASSERT_EQ(unknown.num_starts, std::vector<int>{6});
  SensorSum with_known(known, 3), with_unknown(unknown, 3);
  Matrix whole = Matrix::Zero(9, 9);
  for (size_t i = 0; i < 2; ++i) {
    with_known.Add(known.candidates[i]);
    with_unknown.Add(unknown.candidates[i]);
    whole += unknown.candidates[i].by_record[0];
  }
  // The block of the inverse is the inverse of what is left.
  const Matrix covariance = whole.fullPivLu().inverse().bottomRightCorner(3, 3);
  EXPECT_LT(
      (with_unknown.Information() * covariance - Matrix::Identity(3, 3)).norm(),
      1e-5);
  // Not to know costs something.
  EXPECT_LT(with_unknown.Information().trace(),
            0.999 * with_known.Information().trace());
}

// J'J by differences of the sensors' predictions.
TEST(SensorInformationTest, NonlinearRunsAgainstDifferences) {
  IdentificationProblem problem;
  auto dynamics = testing::MakeSmallNonlinear();
  problem.dynamics = dynamics;
  IdentificationRecord record = testing::MakeExcitedRecord(*dynamics, 60, 0.05);
  record.start = IdentificationRecord::Start::kRest;
  record.substeps = 4;
  const std::vector<CandidateSensor> sensors = {
      SensorAt(Quantity::kDisplacement, 2, 0, 0.5),
      SensorAt(Quantity::kAbsoluteAcceleration, 2, 1, 2.0)};
  for (const CandidateSensor& sensor : sensors) {
    MeasuredChannel channel;
    channel.observation = sensor.observation;
    channel.values = Vector::Zero(60);
    record.channels.push_back(channel);
  }
  problem.records.push_back(record);
  const PlanningInformation information = LinearizeOrFail(problem, {}, sensors);

  const ParameterLayout layout(problem);
  const Vector start = Vector::Zero(dynamics->num_states());
  const auto predict = [&](const Vector& free) {
    Vector all = layout.InitialValues();
    layout.SetFree(free, &all);
    RecordScore score;
    ScoreRecord(problem, 0, all, start, 0, &score);
    return score.prediction;
  };
  const Vector free = layout.Free(layout.InitialValues());
  const int count = layout.num_free();
  std::vector<Matrix> jacobians(2, Matrix(60, count));
  for (int j = 0; j < count; ++j) {
    const Vector step = 1e-5 * Vector::Unit(count, j);
    const Matrix slope = (predict(free + step) - predict(free - step)) / 2e-5;
    for (int c = 0; c < 2; ++c) {
      jacobians[static_cast<size_t>(c)].col(j) = slope.row(c).transpose();
    }
  }
  const Matrix prediction = predict(free);
  for (size_t c = 0; c < 2; ++c) {
    const double sigma = sensors[c].sigma;
    const Matrix expected =
        jacobians[c].transpose() * jacobians[c] / (sigma * sigma);
    const Matrix& found = information.candidates[c].by_record[0];
    EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm());
    EXPECT_NEAR(
        information.candidates[c].rms,
        prediction.row(static_cast<Eigen::Index>(c)).norm() / std::sqrt(60.0),
        1e-9);
  }
}

TEST(SensorInformationTest, LikeSensorsAreEquallyNoisy) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  std::vector<CandidateSensor> sensors;
  for (int i = 0; i < 3; ++i) {
    sensors.push_back(SensorAt(Quantity::kAbsoluteAcceleration, 3, i, 0.0));
    sensors.push_back(SensorAt(Quantity::kDisplacement, 3, i, 0.0));
  }
  // 5 % of the RMS over all places without a sensor of this kind.
  const PlanningInformation bare = LinearizeOrFail(problem, {}, sensors);
  double squares = 0.0;
  for (size_t i = 0; i < 6; i += 2) {
    squares += std::pow(bare.candidates[i].rms, 2.0) / 3.0;
  }
  for (size_t i = 0; i < 6; i += 2) {
    EXPECT_DOUBLE_EQ(bare.candidates[i].sigma, 0.05 * std::sqrt(squares));
    EXPECT_GT(std::abs(bare.candidates[1].sigma - bare.candidates[i].sigma),
              1e-9);
  }
  // The median of those that are there.
  problem.records[0].channels[0].sigma = 0.3;
  problem.records[0].channels[1].sigma = 0.2;
  problem.records[0].channels[2].sigma = 0.7;
  const PlanningInformation beside =
      LinearizeOrFail(problem, OwnSensors(problem), sensors);
  EXPECT_DOUBLE_EQ(beside.candidates[2].sigma, 0.3);
  EXPECT_DOUBLE_EQ(beside.candidates[1].sigma, bare.candidates[1].sigma);
  // A share of its own.
  sensors[4].noise_share = 0.1;
  EXPECT_DOUBLE_EQ(LinearizeOrFail(problem, {}, sensors).candidates[4].sigma,
                   0.1 * bare.candidates[4].rms);
}

// Five per cent of rounding are no noise, by which it would tell much.
TEST(SensorInformationTest, RoundingTellsNothing) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector::Zero(3)), 1);
  std::vector<MeasuredChannel>& channels = problem.records[0].channels;
  ASSERT_GE(channels.size(), 2u);
  for (MeasuredChannel& channel : channels) channel.sigma = 0.0;
  channels[0].observation.weights *= 1e-12;
  CandidateSensor still = SensorAt(channels[0].observation.quantity, 3, 1, 0.0);
  still.observation.weights *= 1e-12;
  const PlanningInformation information =
      LinearizeOrFail(problem, OwnSensors(problem), {still});
  EXPECT_EQ(information.own[0].by_record[0].norm(), 0.0);
  EXPECT_GT(information.own[1].by_record[0].norm(), 0.0);
  // Beside the noise of the others it is next to nothing.
  EXPECT_LT(information.candidates[0].by_record[0].norm(),
            1e-12 * information.own[1].by_record[0].norm());
}

TEST(SensorInformationTest, RefusesInOneSentence) {
  const IdentificationProblem problem =
      MeasuredChain(2, *ChainAt(Vector::Zero(2)), 1);
  const auto refused = [](const IdentificationProblem& wrong,
                          const CandidateSensor& sensor) {
    PlanningInformation information;
    std::string error;
    EXPECT_FALSE(LinearizeSensors(wrong, IdentificationOptions(), {}, {sensor},
                                  &information, &error));
    EXPECT_EQ(error.find('\n'), std::string::npos);
    return error;
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  const CandidateSensor good = SensorAt(Quantity::kVelocity, 2, 0, 0.1);
  CandidateSensor noise = good;
  noise.sigma = -1.0;
  EXPECT_TRUE(has(refused(problem, noise), "velocity1"));
  CandidateSensor size = good;
  size.observation.weights = Vector::Unit(3, 0);
  EXPECT_TRUE(has(refused(problem, size), "velocity1"));

  IdentificationProblem still = problem;
  const Excitation& load = *problem.records[0].excitation;
  still.records[0].excitation.emplace(
      load.start_time(), load.step(),
      Matrix::Zero(load.num_inputs(), load.num_samples()),
      Interpolation::kLinear);
  EXPECT_TRUE(has(refused(still, good), "nothing moves"));
  IdentificationProblem holdout = problem;
  holdout.records[0].role = IdentificationRecord::Role::kHoldout;
  EXPECT_TRUE(has(refused(holdout, good), "training record"));
  IdentificationProblem ambient = problem;
  ambient.ambient.emplace_back();
  EXPECT_TRUE(has(refused(ambient, good), "ambient"));
}

}  // namespace
}  // namespace pinode
