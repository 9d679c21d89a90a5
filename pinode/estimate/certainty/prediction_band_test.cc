#include "pinode/estimate/certainty/prediction_band.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/score.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/gaussian_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using Start = IdentificationRecord::Start;

// One mass with unknown stiffness: a training record, and a hold-out that it is
// to predict.
IdentificationProblem MakeTwoRecords(Start start, uint64_t seed) {
  auto dynamics = testing::MakeGroupedChain(2, 40.0, 0.4);
  const Vector truth = Eigen::Vector2d(0.1, -0.05);
  IdentificationProblem problem;
  testing::Gaussian gaussian(seed);
  double noise[2] = {0.0, 0.0};
  for (const bool holdout : {false, true}) {
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, holdout ? 400 : 100, 0.02);
    record.name = holdout ? "holdout" : "train";
    record.channels = {
        testing::MakeChannel("a1", Quantity::kAbsoluteAcceleration, 2, 0),
        testing::MakeChannel("x2", Quantity::kDisplacement, 2, 1)};
    Vector from = Vector::Zero(4);
    if (start == Start::kFree) from << 0.02, -0.01, 0.1, 0.2;
    testing::Simulate(*dynamics, truth, from, 0.0, 1, &record);
    // The same sensors in both: a tenth of what the first record moves them.
    for (size_t c = 0; c < 2; ++c) {
      Vector& values = record.channels[c].values;
      if (!holdout) noise[c] = 0.1 * StandardDeviationOfPresent(values);
      for (double& value : values) value += noise[c] * gaussian.Next();
    }
    record.start = start;
    if (holdout) {
      record.role = IdentificationRecord::Role::kHoldout;
      record.start_samples = start == Start::kFree ? 30 : 0;
    }
    problem.records.push_back(record);
  }
  problem.dynamics = dynamics;
  return problem;
}

class PredictionBand : public ::testing::TestWithParam<Start> {};

// The expected square of the error is the variance: over many draws, at every
// sample, with little data so that parameters and starts matter beside the
// noise.
TEST_P(PredictionBand, HoldsMeasurementsAsOftenAsItSays) {
  constexpr int kDraws = 60;
  double coverage = 0.0;
  double wider = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const IdentificationProblem problem =
        MakeTwoRecords(GetParam(), static_cast<uint64_t>(draw) + 1);
    IdentificationSummary summary;
    IdentifiedModel model;
    testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &summary,
                         &model);
    ASSERT_EQ(summary.records.size(), 2u);
    const RecordScore& score = summary.records[1];
    ASSERT_EQ(score.deviations.cols(), 400);
    for (int c = 0; c < 2; ++c) {
      coverage += score.channels[static_cast<size_t>(c)].band_coverage;
      wider += score.deviations.row(c).mean() / model.sigmas[1][c];
    }
  }
  coverage /= 2 * kDraws;
  wider /= 2 * kDraws;
  EXPECT_GT(coverage, 0.935);
  EXPECT_LT(coverage, 0.965);
  // More than the noise alone.
  EXPECT_GT(wider, 1.002);
}

INSTANTIATE_TEST_SUITE_P(Starts, PredictionBand,
                         ::testing::Values(Start::kRest, Start::kFree));

// Noise that is assumed says nothing of a sensor that no training record has.
TEST(PredictionBandOfASensor, IsNotThereWithoutItsNoise) {
  IdentificationProblem problem = MakeTwoRecords(Start::kRest, 3);
  problem.records[1].channels[1].observation.name = "another";
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &summary,
                       &model);
  const RecordScore& score = summary.records[1];
  EXPECT_TRUE(std::isfinite(score.channels[0].band_coverage));
  EXPECT_TRUE(std::isnan(score.channels[1].band_coverage));
  EXPECT_TRUE(score.deviations.row(0).allFinite());
  EXPECT_TRUE(std::isnan(score.deviations(1, 0)));
}

// The parameters' share against runs of the model at moved parameters.
TEST(PredictionDeviations, AreThoseOfMovedParameters) {
  const IdentificationProblem problem = MakeTwoRecords(Start::kRest, 3);
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &summary,
                       &model);
  const RecordScore& score = summary.records[1];
  Matrix covariance = Matrix::Zero(2, 2);
  covariance(1, 1) = 1e-6;
  const Vector sigmas = Eigen::Vector2d(1e-9, 1e-9);
  const Matrix deviations = PredictionDeviations(problem, 1, model.parameters,
                                                 covariance, sigmas, score, 1);
  const ParameterLayout layout(problem);
  Vector moved = model.parameters;
  moved[1] += 1e-5;
  RecordScore other;
  ScoreRecord(problem, 1, moved, score.start, 0, &other);
  const Matrix slope = (other.prediction - score.prediction) / 1e-5;
  EXPECT_LT((deviations - 1e-3 * slope.cwiseAbs()).norm(),
            1e-3 * deviations.norm());
  // None where the run is not finite.
  RecordScore failed = score;
  failed.finite = false;
  EXPECT_EQ(PredictionDeviations(problem, 1, model.parameters, covariance,
                                 sigmas, failed, 1)
                .size(),
            0);
}

}  // namespace
}  // namespace pinode
