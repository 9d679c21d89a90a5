#include "pinode/estimate/start/free_run_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/integrate/free_run.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using Role = IdentificationRecord::Role;
using Start = IdentificationRecord::Start;

TEST(FreeRunStart, RestAndKnownNeedNoSample) {
  IdentificationProblem problem;
  auto dynamics = testing::MakeGroupedChain(1, 30.0, 0.5);
  IdentificationRecord record = testing::MakeExcitedRecord(*dynamics, 20, 0.02);
  record.role = Role::kHoldout;
  record.start = Start::kKnown;
  record.known_start = Eigen::Vector2d(1.0, 2.0);
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  Vector start;
  EXPECT_EQ(FreeRunStart(problem, 0, Vector::Zero(1), Vector(0), &start), 0);
  EXPECT_EQ(start, record.known_start);
  problem.records[0].start = Start::kRest;
  EXPECT_EQ(FreeRunStart(problem, 0, Vector::Zero(1), Vector(0), &start), 0);
  EXPECT_EQ(start, Vector::Zero(2));
}

// A hold-out record in the middle of a motion, noise-free, accelerations only.
class HoldoutStart : public ::testing::TestWithParam<double> {
 protected:
  void SetUp() override {
    auto dynamics = testing::MakeGroupedChain(2, 40.0, 0.4);
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, 1000, 0.02);
    // The structure is linear: another unit of length changes no ratio.
    const Matrix scaled = GetParam() * record.excitation->samples();
    record.excitation.emplace(0.0, 0.02, scaled, Interpolation::kLinear);
    record.name = "holdout";
    record.role = Role::kHoldout;
    record.channels = {
        testing::MakeChannel("a1", Quantity::kAbsoluteAcceleration, 2, 0),
        testing::MakeChannel("a2", Quantity::kAbsoluteAcceleration, 2, 1)};
    truth_ = GetParam() * Eigen::Vector4d(0.05, -0.08, 0.3, 0.4);
    testing::Simulate(*dynamics, Vector::Zero(2), truth_, 0.0, 1, &record);
    record.start = Start::kFree;
    sigmas_.resize(2);
    for (int c = 0; c < 2; ++c) {
      sigmas_[c] = 0.05 * StandardDeviationOfPresent(
                              record.channels[static_cast<size_t>(c)].values);
    }
    problem_.records.push_back(record);
    problem_.dynamics = dynamics;
  }
  IdentificationProblem problem_;
  Vector truth_, sigmas_;
};

TEST_P(HoldoutStart, IsSmoothedFromTheFirstSamples) {
  Vector start;
  const Eigen::Index first =
      FreeRunStart(problem_, 0, Vector::Zero(2), sigmas_, &start);
  EXPECT_EQ(first, 50);
  EXPECT_LT((start - truth_).norm(), 1e-3 * truth_.norm());
  RecordScore score;
  ScoreRecord(problem_, 0, Vector::Zero(2), start, first, &score);
  EXPECT_LT(score.nrmse, 1e-3);
  EXPECT_EQ(score.states.cols(), 1000);
  // A start at rest would not have done.
  ScoreRecord(problem_, 0, Vector::Zero(2), Vector::Zero(4), first, &score);
  EXPECT_GT(score.nrmse, 0.05);
}

TEST_P(HoldoutStart, UsesNothingOfTheRest) {
  Vector start, other;
  FreeRunStart(problem_, 0, Vector::Zero(2), sigmas_, &start);
  for (MeasuredChannel& channel : problem_.records[0].channels) {
    channel.values.tail(950).setConstant(17.0);
  }
  FreeRunStart(problem_, 0, Vector::Zero(2), sigmas_, &other);
  EXPECT_EQ(start, other);
}

// A training record's start from its first samples, and from these alone.
TEST_P(HoldoutStart, OfTrainingIsFoundBeforeTheFit) {
  problem_.records[0].role = Role::kTrain;
  problem_.records[0].start_samples = 50;
  for (MeasuredChannel& channel : problem_.records[0].channels) {
    channel.values.tail(950).setConstant(17.0 * GetParam());
  }
  IdentificationProblem without = problem_;
  without.records[0].start_samples = 0;
  FixTrainingStarts(&problem_);
  EXPECT_EQ(problem_.records[0].start, Start::kKnown);
  EXPECT_LT((problem_.records[0].known_start - truth_).norm(),
            1e-3 * truth_.norm());
  FixTrainingStarts(&without);
  EXPECT_EQ(without.records[0].start, Start::kFree);
}

INSTANTIATE_TEST_SUITE_P(Units, HoldoutStart,
                         ::testing::Values(1.0, 1e-6, 1e6));

// The excitation between the last visible samples depends on later samples: a
// sinc looks 32 samples ahead. These are known.
TEST(FreeRunStart, ShortBeginningOfABandLimitedRecord) {
  auto dynamics = testing::MakeGroupedChain(1, 4000.0, 2.0);
  IdentificationRecord record = testing::MakeExcitedRecord(
      *dynamics, 400, 0.02, Interpolation::kBandLimited);
  Matrix samples(1, 400);
  for (int i = 0; i < 400; ++i) samples(0, i) = std::sin(2.0 * i + 0.4);
  record.excitation.emplace(0.0, 0.02, samples, Interpolation::kBandLimited);
  record.role = Role::kHoldout;
  record.substeps = 20;
  record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0)};
  const Vector truth = Eigen::Vector2d(1e-4, -3e-3);
  testing::Simulate(*dynamics, Vector::Zero(1), truth, 0.0, 1, &record);
  record.start = Start::kFree;
  record.start_samples = 30;
  IdentificationProblem problem;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  Vector start;
  EXPECT_EQ(FreeRunStart(problem, 0, Vector::Zero(1), Vector::Constant(1, 1e-9),
                         &start),
            30);
  EXPECT_LT((start - truth).norm(), 1e-6 * truth.norm());
}

// A harmonic ground motion over a whole number of periods: the closed form.
TEST(FindSteadyState, OfALinearOscillator) {
  const double k = 40.0, c = 0.02;
  auto dynamics = testing::MakeGroupedChain(1, k, c);
  const int samples = 200;
  const double step = 0.02;
  const double omega = 2.0 * kPi * 4.0 / (samples * step);
  Matrix ground(1, samples);
  for (int i = 0; i < samples; ++i) ground(0, i) = std::cos(omega * i * step);
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, samples, step);
  record.excitation.emplace(0.0, step, ground, Interpolation::kBandLimited,
                            true);
  record.start = Start::kFree;
  record.role = Role::kHoldout;
  record.substeps = 8;
  record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0)};
  record.channels[0].values = Vector::Ones(samples);
  IdentificationProblem problem;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  const double m = dynamics->model().mass(0, 0);
  const std::complex<double> amplitude =
      -m / std::complex<double>(k - m * omega * omega, c * omega);
  Vector start;
  // Plain repetition would need some thousand periods.
  ASSERT_TRUE(FindSteadyState(problem, 0, Vector::Zero(1), &start));
  EXPECT_NEAR(start[0], amplitude.real(), 1e-4 * std::abs(amplitude));
  EXPECT_NEAR(start[1], -omega * amplitude.imag(),
              1e-4 * omega * std::abs(amplitude));
  // No sample of the record is used, and all are scored.
  Vector free_start;
  EXPECT_EQ(
      FreeRunStart(problem, 0, Vector::Zero(1), Vector::Ones(1), &free_start),
      0);
  EXPECT_EQ(free_start, start);
}

// With hysteresis, against as many repetitions as it takes.
TEST(FindSteadyState, OfAHystereticOscillator) {
  auto dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(1, 30.0, 0.6),
      std::vector<InputSpec>{{InputSpec::Kind::kGroundAcceleration, 0, "ag"}});
  std::string error;
  ASSERT_TRUE(dynamics->AddElement("device", "bouc_wen", Feature::kGround, 0,
                                   {1.0, 40.0, 30.0, -12.0, 1.0}, &error))
      << error;
  const int samples = 150;
  Matrix ground(1, samples);
  for (int i = 0; i < samples; ++i) {
    const double phase = 2.0 * kPi * i / samples;
    ground(0, i) = 8.0 * std::cos(3.0 * phase) + 5.0 * std::sin(4.0 * phase);
  }
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, samples, 0.02);
  record.excitation.emplace(0.0, 0.02, ground, Interpolation::kLinear, true);
  record.start = Start::kFree;
  record.substeps = 4;
  IdentificationProblem problem;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  const Vector theta = dynamics->Parameters();
  Vector start;
  ASSERT_TRUE(FindSteadyState(problem, 0, theta, &start));
  StructuralDynamics::Prepared prepared;
  ASSERT_TRUE(dynamics->Prepare(theta, &prepared, &error));
  const ObservationMap nothing(*dynamics, {});
  const IntegrationGrid grid(*record.excitation, record.substeps);
  Vector state = Vector::Zero(3);
  Trajectory trajectory;
  for (int period = 0; period < 200; ++period) {
    ASSERT_TRUE(FreeRun(*dynamics, prepared, nothing, grid, state, 0,
                        grid.num_intervals(), &trajectory));
    state = trajectory.states.rightCols(1);
  }
  const Vector scale = trajectory.states.rowwise().norm() / std::sqrt(samples);
  EXPECT_LT((start - state).cwiseQuotient(scale).norm(), 1e-7);
}

// A mass that nothing holds drifts away.
TEST(FindSteadyState, IsNotThereForAFreeMass) {
  auto dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(1, 0.0, 0.0),
      std::vector<InputSpec>{{InputSpec::Kind::kGroundAcceleration, 0, "ag"}});
  IdentificationRecord record = testing::MakeExcitedRecord(*dynamics, 40, 0.02);
  record.excitation.emplace(0.0, 0.02, Matrix::Ones(1, 40),
                            Interpolation::kLinear, true);
  record.start = Start::kFree;
  record.substeps = 1;
  IdentificationProblem problem;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  Vector start;
  EXPECT_FALSE(FindSteadyState(problem, 0, Vector(0), &start));
  EXPECT_TRUE(start.allFinite());
}

}  // namespace
}  // namespace pinode
