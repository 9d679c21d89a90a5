#include "pinode/study/problem/prior_comparison.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/start/free_run_start.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/problem/make_problem.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

TEST(PriorComparisonTest, PairsModes) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  IdentifiedModel model;
  model.parameters = fit.layout->InitialValues();
  const PriorComparison same = CompareWithPrior(fit.problem, model);
  ASSERT_EQ(same.modes.size(), 2u);
  EXPECT_EQ(same.why_no_modes, "");
  for (const ModePair& mode : same.modes) {
    EXPECT_NEAR(mode.mac, 1.0, 1e-12);
    EXPECT_NEAR(mode.updated_frequency, mode.initial_frequency, 1e-12);
  }
  model.parameters[0] += 0.2;
  const PriorComparison stiffer = CompareWithPrior(fit.problem, model);
  EXPECT_GT(stiffer.modes[0].updated_frequency,
            stiffer.modes[0].initial_frequency);
}

TEST(PriorComparisonTest, LeavesOutWhatIsNotThere) {
  testing::SmallFit fit(IdentificationRecord::Start::kRest);
  PriorComparison comparison = CompareWithPrior(fit.problem, IdentifiedModel());
  EXPECT_TRUE(comparison.modes.empty());
  fit.problem.records[0].substeps = 0;
  comparison = CompareWithPrior(fit.problem, IdentifiedModel());
  EXPECT_THAT(comparison.why_no_modes, ::testing::HasSubstr("PrepareProblem"));
}

// Gains, offsets and delays of the sensors included, and starts that are to be
// found.
TEST(PriorRunsTest, AreThoseOfTheScoredRun) {
  for (const auto start : {IdentificationRecord::Start::kRest,
                           IdentificationRecord::Start::kFree}) {
    testing::SmallFit fit(start);
    // Noise levels of another problem.
    IdentifiedModel model;
    model.sigmas = {Vector::Ones(7)};
    const Vector prior = fit.layout->InitialValues();
    PriorRuns runs(fit.problem, model);
    for (int r = 0; r < 2; ++r) {
      Vector state;
      const Eigen::Index first =
          FreeRunStart(fit.problem, r, prior, Vector::Ones(4), &state);
      RecordScore score;
      ScoreRecord(fit.problem, r, prior, state, first, &score);
      ASSERT_TRUE(score.finite);
      EXPECT_EQ(runs.Run(r, {0, 1, 2, 3}), score.prediction);
      const Matrix some = runs.Run(r, {3, 1});
      ASSERT_EQ(some.rows(), 2);
      EXPECT_EQ(some.row(0), score.prediction.row(3));
      EXPECT_EQ(some.row(1), score.prediction.row(1));
    }
    EXPECT_EQ(runs.Run(0, {}).size(), 0);
  }
}

// Exactly, where the record is: not by the steps of Runge and Kutta that it has
// beside that.
TEST(PriorRunsTest, AreIntegratedAsTheRecordIs) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(2, 400.0, 0.5);
  IdentificationRecord record =
      testing::MakeExcitedRecord(*problem.dynamics, 400, 0.02);
  for (int dof = 0; dof < 2; ++dof) {
    record.channels.push_back(testing::MakeChannel(
        "a" + std::to_string(dof), Quantity::kAbsoluteAcceleration, 2, dof));
  }
  record.start = IdentificationRecord::Start::kRest;
  testing::Simulate(*problem.dynamics, problem.dynamics->Parameters(),
                    Vector::Zero(4), 0.01, 1, &record);
  problem.records.push_back(record);
  std::string error;
  ASSERT_TRUE(PrepareProblem(&problem, &error)) << error;
  RecordScore score;
  ScoreRecord(problem, 0, ParameterLayout(problem).InitialValues(),
              Vector::Zero(4), 0, &score);
  ASSERT_TRUE(score.finite);
  const IdentifiedModel model;
  EXPECT_EQ(PriorRuns(problem, model).Run(0, {0, 1}), score.prediction);
}

TEST(PriorRunsTest, AreNoneOfAProblemThatIsNotValid) {
  testing::SmallFit fit(IdentificationRecord::Start::kRest);
  const IdentifiedModel model;
  fit.problem.records[0].substeps = 0;
  EXPECT_EQ(PriorRuns(fit.problem, model).Run(0, {0}).size(), 0);
}

}  // namespace
}  // namespace pinode
