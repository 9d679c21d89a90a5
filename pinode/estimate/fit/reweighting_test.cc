#include "pinode/estimate/fit/reweighting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/problem/assumed_noise.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// A chain with two training records and a hold-out record of the same sensor.
class ReweightingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto dynamics = testing::MakeGroupedChain(1, 40.0, 0.4);
    for (int r = 0; r < 3; ++r) {
      IdentificationRecord record =
          testing::MakeExcitedRecord(*dynamics, 200, 0.05);
      record.channels = {
          testing::MakeChannel("x", Quantity::kDisplacement, 1, 0)};
      truth_ = testing::Simulate(*dynamics, Vector::Zero(1), Vector::Zero(2),
                                 0.1, static_cast<uint64_t>(r + 1), &record);
      record.name = "r" + std::to_string(r);
      if (r == 2) record.role = IdentificationRecord::Role::kHoldout;
      problem_.records.push_back(record);
    }
    problem_.dynamics = dynamics;
  }

  double SpreadOf(size_t record) const {
    return StandardDeviationOfPresent(
        problem_.records[record].channels[0].values);
  }

  IdentificationProblem problem_;
  Matrix truth_;
};

TEST_F(ReweightingTest, AssumesAShareOfTheSpread) {
  problem_.records[1].channels[0].sigma = 0.3;
  const auto sigmas = AssumedNoise(problem_, NoiseTuning());
  ASSERT_EQ(sigmas.size(), 2u);
  EXPECT_DOUBLE_EQ(sigmas[0][0], 0.05 * SpreadOf(0));
  EXPECT_EQ(sigmas[1][0], 0.3);
}

TEST_F(ReweightingTest, TheSameSensorHasTheSameNoise) {
  const std::vector<Vector> train = {Vector::Constant(1, 0.1),
                                     Vector::Constant(1, 0.2)};
  auto all = NoiseOfAllRecords(problem_, FindTrainedSensors(problem_), train,
                               NoiseTuning());
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0][0], 0.1);
  EXPECT_EQ(all[2][0], 0.2);
  problem_.records[2].channels[0].observation.name = "another";
  all = NoiseOfAllRecords(problem_, FindTrainedSensors(problem_), train,
                          NoiseTuning());
  EXPECT_DOUBLE_EQ(all[2][0], 0.05 * SpreadOf(2));
}

// The last training record counts, in which the sensor was fitted.
TEST_F(ReweightingTest, FindsWhereASensorWasTrained) {
  TrainedSensors trained = FindTrainedSensors(problem_);
  ASSERT_EQ(trained.size(), 3u);
  ASSERT_EQ(trained[2].size(), 1u);
  ASSERT_TRUE(trained[2][0].has_value());
  EXPECT_EQ(trained[2][0]->record, 1u);
  EXPECT_EQ(trained[2][0]->channel, 0);
  problem_.records[1].channels[0].fit = false;
  trained = FindTrainedSensors(problem_);
  ASSERT_TRUE(trained[2][0].has_value());
  EXPECT_EQ(trained[2][0]->record, 0u);
  problem_.records[2].channels[0].observation.name = "another";
  EXPECT_FALSE(FindTrainedSensors(problem_)[2][0].has_value());
}

TEST_F(ReweightingTest, ComesToTheNoiseOfTheTruth) {
  const ParameterLayout layout(problem_);
  Objective objective(problem_, layout, MultipleShooting::Options());
  const IdentificationOptions options;
  FitSummary summary;
  const FitContext context{problem_, options, layout, objective, summary};
  FitLog log(options, nullptr, &summary);
  Annealing annealing(context);
  Reweighting reweighting(context, &log, &annealing);
  FitState state;
  state.free = Vector::Zero(1);
  state.sigmas = reweighting.FirstSigmas(nullptr);
  EXPECT_DOUBLE_EQ(state.sigmas[0][0], 0.05 * SpreadOf(0));
  SetSegments(0, {truth_, truth_}, &objective.shooting());
  objective.shooting().SetSigmas(state.sigmas);
  Reweighting::Outcome outcome;
  for (int round = 0; round < 5; ++round) {
    outcome = reweighting.Update(true, &state);
  }
  EXPECT_TRUE(outcome.noise_is_quiet);
  EXPECT_TRUE(outcome.is_quiet);
  EXPECT_NEAR(summary.effective_parameters, 1.0, 1e-6);
  // One parameter of 400 samples.
  EXPECT_NEAR(state.share_left, 1.0 - 1.0 / 400.0, 1e-6);
  // 200 samples: to 5 %, three times.
  for (size_t r = 0; r < 2; ++r) {
    EXPECT_NEAR(state.sigmas[r][0], 0.1 * SpreadOf(r), 0.015 * SpreadOf(r));
  }
}

}  // namespace
}  // namespace pinode
