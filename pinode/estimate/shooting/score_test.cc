#include "pinode/estimate/shooting/score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using Start = IdentificationRecord::Start;

// A free mass: x = x0 + v0 t, which Runge-Kutta meets exactly.
TEST(ScoreRecord, EqualsTheFormulaByHand) {
  IdentificationProblem problem;
  problem.dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(1, 0.0, 0.0), std::vector<InputSpec>{});
  IdentificationRecord record;
  record.name = "slide";
  record.substeps = 1;
  record.excitation.emplace(0.0, 1.0, Matrix(0, 6), Interpolation::kLinear);
  record.start = Start::kKnown;
  record.known_start = Eigen::Vector2d(1.0, 2.0);
  record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0),
                     testing::MakeChannel("v", Quantity::kVelocity, 1, 0),
                     testing::MakeChannel("a", Quantity::kVelocity, 1, 0)};
  // Predicted: 1, 3, 5, 7, 9, 11.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  record.channels[0].values = (Vector(6) << 9, 9, 4, 8, nan, 12).finished();
  record.channels[1].values = Vector::LinSpaced(6, 0.0, 5.0);
  record.channels[2].values = (Vector(6) << 0, 1, 1, 0, 0, 1).finished();
  record.channels[2].fit = false;
  problem.records.push_back(record);

  RecordScore score;
  ScoreRecord(problem, 0, Vector(0), record.known_start, 2, &score);
  ASSERT_TRUE(score.finite);
  EXPECT_EQ(score.name, "slide");
  EXPECT_EQ(score.first_scored_sample, 2);
  EXPECT_NEAR(score.prediction(0, 5), 11.0, 1e-12);
  // x: residuals -1, 1, 1 about a mean of 8 with deviations -4, 0, 4.
  EXPECT_NEAR(score.channels[0].rmse, 1.0, 1e-12);
  EXPECT_NEAR(score.channels[0].nrmse, std::sqrt(3.0 / 32.0), 1e-12);
  // v: residuals 0, 1, 2, 3 about a mean of 3.5.
  EXPECT_NEAR(score.channels[1].rmse, std::sqrt(14.0 / 4.0), 1e-12);
  EXPECT_NEAR(score.channels[1].nrmse, std::sqrt(14.0 / 5.0), 1e-12);
  // The channel that is not fitted is scored, but does not count.
  EXPECT_NEAR(score.channels[2].rmse, std::sqrt((1 + 4 + 4 + 1) / 4.0), 1e-12);
  EXPECT_NEAR(score.nrmse, std::sqrt(0.5 * (3.0 / 32.0 + 14.0 / 5.0)), 1e-12);
  EXPECT_NEAR(CombinedError(record, score), score.nrmse, 1e-15);
}

TEST(ScoreRecord, SensorsApply) {
  IdentificationProblem problem;
  auto dynamics = testing::MakeGroupedChain(1, 30.0, 0.5);
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 100, 0.02);
  record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0)};
  testing::Simulate(*dynamics, Vector::Zero(1), Vector::Zero(2), 0.0, 1,
                    &record);
  record.channels[0].values = (1.5 * record.channels[0].values).array() + 0.3;
  record.channels[0].gain = 0;
  record.channels[0].offset = 1;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  problem.sensors.name = "sensors";
  problem.sensors.parameters.resize(2);
  problem.sensors.parameters[0].name = "gain";
  problem.sensors.parameters[1].name = "offset";
  RecordScore score;
  ScoreRecord(problem, 0, Eigen::Vector3d(0.0, 1.5, 0.3), Vector::Zero(2), 0,
              &score);
  EXPECT_LT(score.nrmse, 1e-12);
  ScoreRecord(problem, 0, Eigen::Vector3d(0.0, 1.0, 0.0), Vector::Zero(2), 0,
              &score);
  EXPECT_GT(score.nrmse, 0.3);
}

// What was summed on the way says the same as a run of its own.
TEST(FreeRunError, EqualsThatOfScores) {
  for (const Start start : {Start::kFree, Start::kKnown}) {
    testing::SmallFit fit(start);
    auto objective = fit.Shoot(0, MultipleShooting::Options());
    MultipleShooting& shooting = objective->shooting();
    const double run =
        FreeRunError(fit.problem, *fit.layout, shooting, fit.free);
    ASSERT_EQ(shooting.state().SquaresAt(fit.free), nullptr);
    CondensedSystem system;
    ASSERT_TRUE(objective->Linearize(fit.free, &system));
    ASSERT_NE(shooting.state().SquaresAt(fit.free), nullptr);
    const double summed =
        FreeRunError(fit.problem, *fit.layout, shooting, fit.free);
    Vector parameters = fit.layout->InitialValues();
    fit.layout->SetFree(fit.free, &parameters);
    double sum = 0.0;
    for (size_t t = 0; t < shooting.train_records().size(); ++t) {
      RecordScore score;
      ScoreRecord(fit.problem, shooting.train_records()[t], parameters,
                  shooting.starts()[t].col(0), 0, &score);
      sum += score.nrmse * score.nrmse;
    }
    const double expected =
        std::sqrt(sum / static_cast<double>(shooting.train_records().size()));
    EXPECT_NEAR(summed, expected, 1e-12 * expected);
    if (start == Start::kKnown) {
      EXPECT_NEAR(run, expected, 1e-12 * expected);
    }
  }
}

TEST(ScoreRecord, DivergingRunHasInfiniteErrors) {
  IdentificationProblem problem;
  auto dynamics = testing::MakeGroupedChain(1, 4000.0, 0.0);
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 400, 0.02);
  record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0)};
  testing::Simulate(*dynamics, Vector::Zero(1), Vector::Zero(2), 0.0, 1,
                    &record);
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  RecordScore score;
  ScoreRecord(problem, 0, Vector::Constant(1, -3.0), Vector::Zero(2), 0,
              &score);
  EXPECT_FALSE(score.finite);
  EXPECT_TRUE(std::isinf(score.nrmse));
  EXPECT_TRUE(std::isinf(score.channels[0].nrmse));
  EXPECT_TRUE(std::isinf(score.channels[0].rmse));
  EXPECT_TRUE(std::isinf(CombinedError(problem.records[0], score)));
  // It shows how far it came.
  EXPECT_TRUE(std::isfinite(score.prediction(0, 50)));
  EXPECT_TRUE(std::isnan(score.prediction(0, 399)));
}

}  // namespace
}  // namespace pinode
