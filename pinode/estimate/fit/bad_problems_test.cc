// Problems that a caller can get wrong, on everything that takes a problem:
// each comes back with a sentence, and nothing aborts.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/estimate/certainty/assessment.h"
#include "pinode/estimate/segment_cost.h"
#include "pinode/estimate/trajectory_cost.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

IdentificationProblem GoodProblem() {
  auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
  IdentificationRecord record = testing::MakeExcitedRecord(*dynamics, 40, 0.05);
  record.name = "r";
  record.channels = {testing::MakeChannel("x1", Quantity::kDisplacement, 2, 0)};
  testing::Simulate(*dynamics, Eigen::Vector2d(0.1, 0.0), Vector::Zero(4), 0.02,
                    3, &record);
  IdentificationProblem problem;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  problem.sensors.name = "sensors";
  return problem;
}

struct BadProblem {
  std::string name;
  std::function<void(IdentificationProblem*)> spoil;
  std::string message;
};

MeasuredChannel& ChannelOf(IdentificationProblem* problem) {
  return problem->records[0].channels[0];
}

std::vector<BadProblem> BadProblems() {
  using Problem = IdentificationProblem;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {
      {"NoModel", [](Problem* p) { p->dynamics.reset(); }, "there is no model"},
      {"NoRecords", [](Problem* p) { p->records.clear(); },
       "no training record has a fitted channel"},
      {"HoldoutsAlone",
       [](Problem* p) {
         p->records[0].role = IdentificationRecord::Role::kHoldout;
       },
       "no training record has a fitted channel"},
      {"NothingFitted", [](Problem* p) { ChannelOf(p).fit = false; },
       "no training record has a fitted channel"},
      {"NoExcitation", [](Problem* p) { p->records[0].excitation.reset(); },
       "record 'r': it has fewer than two samples"},
      {"OneSample",
       [](Problem* p) {
         p->records[0].excitation.emplace(0.0, 0.1, Matrix::Zero(1, 1),
                                          Interpolation::kLinear);
       },
       "record 'r': it has fewer than two samples"},
      {"InputsOfAnotherModel",
       [](Problem* p) {
         p->records[0].excitation.emplace(0.0, 0.05, Matrix::Zero(3, 40),
                                          Interpolation::kLinear);
       },
       "record 'r': it has 3 inputs, the model has 1"},
      {"NotANumberInput",
       [nan](Problem* p) {
         p->records[0].excitation.emplace(
             0.0, 0.05, Matrix::Constant(1, 40, nan), Interpolation::kLinear);
       },
       "record 'r': its excitation holds a value, or has a step, that is not "
       "finite"},
      {"NoSamplingStep",
       [](Problem* p) {
         p->records[0].excitation.emplace(0.0, 0.0, Matrix::Zero(1, 40),
                                          Interpolation::kLinear);
       },
       "record 'r': its excitation holds a value, or has a step, that is not "
       "finite"},
      {"NoStep", [](Problem* p) { p->records[0].substeps = 0; },
       "record 'r': it needs at least one Runge-Kutta step"},
      {"TooManyInputSigmas",
       [](Problem* p) { p->records[0].input_sigma = Vector::Ones(2); },
       "record 'r': it has 2 standard deviations of inputs, the model has 1"},
      {"NegativeInputSigma",
       [](Problem* p) {
         p->records[0].input_sigma = Vector::Constant(1, -1.0);
       },
       "record 'r': the standard deviation of an input is negative"},
      {"NotANumberInputSigma",
       [nan](Problem* p) {
         p->records[0].input_sigma = Vector::Constant(1, nan);
       },
       "record 'r': the standard deviation of an input is negative or not"},
      {"ShortStart",
       [](Problem* p) {
         p->records[0].start = IdentificationRecord::Start::kKnown;
         p->records[0].known_start = Vector::Zero(3);
       },
       "record 'r': its start needs 4 finite values"},
      {"InfiniteStart",
       [](Problem* p) {
         p->records[0].start = IdentificationRecord::Start::kKnown;
         p->records[0].known_start = Vector::Constant(4, kInfinity);
       },
       "record 'r': its start needs 4 finite values"},
      {"NoChannel", [](Problem* p) { p->records[0].channels.clear(); },
       "record 'r': it has no measured channel"},
      {"ShortChannel",
       [](Problem* p) { ChannelOf(p).values = Vector::Ones(39); },
       "channel 'x1': its length differs from that of the excitation"},
      {"EmptyChannel", [](Problem* p) { ChannelOf(p).values.resize(0); },
       "channel 'x1': its length differs from that of the excitation"},
      {"InfiniteSample", [](Problem* p) { ChannelOf(p).values[3] = kInfinity; },
       "channel 'x1': it holds an infinite value"},
      {"HugeValue", [](Problem* p) { ChannelOf(p).values[3] = 1e200; },
       "channel 'x1': it holds a value beyond 1e140"},
      {"HugeExcitation",
       [](Problem* p) {
         Matrix samples = p->records[0].excitation->samples();
         samples(0, 5) = -1e200;
         p->records[0].excitation.emplace(0.0, 0.05, samples,
                                          Interpolation::kLinear);
       },
       "its excitation holds a value beyond 1e140"},
      {"NoSample", [nan](Problem* p) { ChannelOf(p).values.setConstant(nan); },
       "channel 'x1': it holds no value"},
      {"NegativeSigma", [](Problem* p) { ChannelOf(p).sigma = -1.0; },
       "channel 'x1': its standard deviation is negative"},
      {"InfiniteSigma", [](Problem* p) { ChannelOf(p).sigma = kInfinity; },
       "channel 'x1': its standard deviation is not finite"},
      {"WeightsOfAnotherModel",
       [](Problem* p) {
         ChannelOf(p).observation.weights = Vector::Unit(3, 0);
       },
       "channel 'x1': it has 3 weights, the model has 2 DOFs"},
      {"NoWeights",
       [](Problem* p) { ChannelOf(p).observation.weights.resize(0); },
       "channel 'x1': it has 0 weights, the model has 2 DOFs"},
      {"NotANumberWeight",
       [nan](Problem* p) { ChannelOf(p).observation.weights[1] = nan; },
       "channel 'x1': a weight of its DOFs is not finite"},
      {"NoGroundDisplacement",
       [](Problem* p) {
         ChannelOf(p).observation.quantity = Quantity::kAbsoluteDisplacement;
       },
       "needs the ground displacement among the inputs"},
      {"GainOfNoSensor", [](Problem* p) { ChannelOf(p).gain = 0; },
       "channel 'x1': its gain is sensor parameter 0, the problem has 0"},
      {"OffsetOfNoSensor", [](Problem* p) { ChannelOf(p).offset = 7; },
       "channel 'x1': its offset is sensor parameter 7"},
      {"NegativeDelayIndex", [](Problem* p) { ChannelOf(p).delay = -2; },
       "channel 'x1': its delay is sensor parameter -2"},
      {"FilterOverGaps",
       [nan](Problem* p) {
         p->records[0].filter = std::make_shared<ZeroPhaseFilter>(
             FilterOptions{FilterType::kLowPass, {2.0}, 2}, 0.05);
         ChannelOf(p).values[5] = nan;
       },
       "a record with missing samples cannot be filtered"},
      {"SensorOutsideItsBounds",
       [](Problem* p) {
         Parameter gain;
         gain.name = "gain";
         gain.value = 2.0;
         gain.upper = 1.0;
         p->sensors.parameters.push_back(gain);
       },
       "lies outside its bounds"},
  };
}

class BadProblemTest : public ::testing::TestWithParam<BadProblem> {};

TEST_P(BadProblemTest, IsRefusedEverywhere) {
  IdentificationProblem problem = GoodProblem();
  GetParam().spoil(&problem);
  const std::string& message = GetParam().message;

  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &summary,
                       &model);
  EXPECT_FALSE(summary.usable());
  EXPECT_EQ(summary.termination, Termination::kFailure);
  EXPECT_THAT(summary.message, HasSubstr(message));

  std::string error;
  ProblemAssessment assessment;
  EXPECT_FALSE(
      AssessProblem(problem, IdentificationOptions(), &assessment, &error));
  EXPECT_THAT(error, HasSubstr(message));
  error.clear();
  EXPECT_EQ(TrajectoryCost::Create(problem, TrajectoryCost::Options(), &error),
            nullptr);
  EXPECT_THAT(error, HasSubstr(message));
  error.clear();
  EXPECT_EQ(
      SegmentCost::Create(problem, 0, 0, 20, SegmentCost::Options(), &error),
      nullptr);
  EXPECT_THAT(error, HasSubstr(message));
}

INSTANTIATE_TEST_SUITE_P(All, BadProblemTest,
                         ::testing::ValuesIn(BadProblems()),
                         [](const auto& bad) { return bad.param.name; });

TEST(BadProblems, TheGoodOneIsGood) {
  const IdentificationProblem problem = GoodProblem();
  std::string error;
  EXPECT_TRUE(problem.IsValid(&error)) << error;
}

TEST(BadProblems, AnInitialModelOfAnotherProblemIsRefused) {
  const IdentificationProblem problem = GoodProblem();
  IdentifiedModel initial;
  initial.parameters = Vector::Zero(7);
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, IdentificationOptions(), &initial, &summary,
                       &model);
  EXPECT_EQ(summary.termination, Termination::kFailure);
  EXPECT_THAT(summary.message, HasSubstr("has 7 parameters, the problem has"));
}

TEST(BadProblems, SegmentsAndOptionsAreChecked) {
  const IdentificationProblem problem = GoodProblem();
  std::string error;
  const auto segment = [&](int record, int first, int last,
                           const SegmentCost::Options& options) {
    error.clear();
    EXPECT_EQ(
        SegmentCost::Create(problem, record, first, last, options, &error),
        nullptr);
    return error;
  };
  SegmentCost::Options options;
  EXPECT_THAT(segment(1, 0, 9, options), HasSubstr("no record 1 among 1"));
  EXPECT_THAT(segment(-1, 0, 9, options), HasSubstr("no record -1"));
  EXPECT_THAT(segment(0, 9, 9, options), HasSubstr("none of its 40 samples"));
  EXPECT_THAT(segment(0, 0, 40, options), HasSubstr("none of its 40 samples"));
  options.gap_sigmas = Vector::Ones(3);
  EXPECT_THAT(segment(0, 0, 9, options), HasSubstr("4 positive numbers"));
  options = SegmentCost::Options();
  options.sigmas = Vector::Zero(1);
  EXPECT_THAT(segment(0, 0, 9, options), HasSubstr("1 positive numbers"));

  TrajectoryCost::Options trajectory;
  trajectory.sigmas = {Vector::Ones(2)};
  EXPECT_EQ(TrajectoryCost::Create(problem, trajectory, &error), nullptr);
  EXPECT_THAT(error, HasSubstr("1 positive numbers"));
  trajectory.sigmas = {Vector::Ones(1), Vector::Ones(1)};
  EXPECT_EQ(TrajectoryCost::Create(problem, trajectory, &error), nullptr);
  EXPECT_THAT(error, HasSubstr("2 training records of 1"));
  trajectory = TrajectoryCost::Options();
  trajectory.segment_samples = 1;
  EXPECT_EQ(TrajectoryCost::Create(problem, trajectory, &error), nullptr);
  EXPECT_THAT(error, HasSubstr("segment_samples is 1"));
  trajectory = TrajectoryCost::Options();
  trajectory.num_threads = 0;
  EXPECT_EQ(TrajectoryCost::Create(problem, trajectory, &error), nullptr);
  EXPECT_THAT(error, HasSubstr("num_threads"));
}

}  // namespace
}  // namespace pinode
