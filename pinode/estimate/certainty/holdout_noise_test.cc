#include "pinode/estimate/certainty/holdout_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pinode/base/constants.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/gaussian_testing.h"

namespace pinode {
namespace {

constexpr int kHoldoutSamples = 4000;

// One sensor in a training record and a hold-out. Both see a sine of unit size
// with `period` samples, which the model predicts but for `misfit` of it.
class HoldoutNoiseTest : public ::testing::Test {
 protected:
  void Make(double train_noise, double holdout_noise, double period,
            double misfit) {
    problem_ = IdentificationProblem();
    scores_.clear();
    sigmas_.clear();
    testing::Gaussian gaussian(5);
    for (const double noise : {train_noise, holdout_noise}) {
      IdentificationRecord record;
      record.name = problem_.records.empty() ? "train" : "holdout";
      if (!problem_.records.empty()) {
        record.role = IdentificationRecord::Role::kHoldout;
      }
      MeasuredChannel channel =
          testing::MakeChannel("a", Quantity::kDisplacement, 1, 0);
      channel.values.resize(kHoldoutSamples);
      RecordScore score;
      score.finite = true;
      score.prediction.resize(1, kHoldoutSamples);
      for (int i = 0; i < kHoldoutSamples; ++i) {
        const double motion = std::sin(2.0 * kPi * i / period);
        score.prediction(0, i) = (1.0 - misfit) * motion;
        channel.values[i] = motion + noise * gaussian.Next();
      }
      record.channels = {channel};
      problem_.records.push_back(record);
      scores_.push_back(score);
      // Residuals of a fit of the first record.
      sigmas_.push_back(Vector::Constant(
          1, std::hypot(train_noise, misfit / std::sqrt(2.0))));
    }
  }

  double Noise(int record = 1) const {
    return HoldoutNoise(problem_, FindTrainedSensors(problem_), record, sigmas_,
                        scores_)[0];
  }

  IdentificationProblem problem_;
  std::vector<Vector> sigmas_;
  std::vector<RecordScore> scores_;
};

// From 4000 samples the deviation has a relative standard deviation of 2 %.
TEST_F(HoldoutNoiseTest, IsSeenBeyondTheMotion) {
  Make(0.02, 0.03, 8.0, 0.0);
  EXPECT_NEAR(Noise(), 0.03, 0.002);
  EXPECT_EQ(Noise(0), 0.02) << "of a training record the fit knows better";
  Make(0.02, 0.01, 8.0, 0.0);
  EXPECT_NEAR(Noise(), 0.01, 0.001);
}

TEST_F(HoldoutNoiseTest, WhatTheModelCannotDoStaysAsItIs) {
  Make(0.02, 0.03, 8.0, 0.1);
  EXPECT_NEAR(Noise(), std::hypot(0.03, 0.1 / std::sqrt(2.0)), 0.001);
  // A misfit is no noise, however wrong the model is.
  Make(0.02, 0.02, 8.0, 0.9);
  EXPECT_EQ(Noise(), sigmas_[1][0]);
}

TEST_F(HoldoutNoiseTest, IsThatOfTrainingWhereItCannotBeTold) {
  Make(0.02, 0.02, 8.0, 0.0);
  EXPECT_EQ(Noise(), 0.02) << "no difference to speak of";
  Make(0.02, 0.03, 2.2, 0.0);
  EXPECT_EQ(Noise(), 0.02) << "motion at the highest frequencies";
  Make(0.02, 0.03, 8.0, 0.0);
  problem_.records[1].channels[0].sigma = 0.02;
  EXPECT_EQ(Noise(), 0.02) << "given";
  problem_.records[1].channels[0].sigma = 0.0;
  problem_.records[1].channels[0].observation.name = "b";
  EXPECT_EQ(Noise(), 0.02) << "another sensor";
  Make(0.02, 0.03, 8.0, 0.0);
  for (int i = 0; i < kHoldoutSamples; i += 8) {
    problem_.records[1].channels[0].values[i] = kNaN;
  }
  EXPECT_EQ(Noise(), 0.02) << "no nine samples without a gap";
  Make(0.02, 0.03, 8.0, 0.0);
  scores_[1].finite = false;
  EXPECT_EQ(Noise(), 0.02) << "no run";
}

TEST_F(HoldoutNoiseTest, IsToldInASentence) {
  Make(0.02, 0.03, 8.0, 0.0);
  const Vector train = Vector::Constant(1, 0.02);
  EXPECT_EQ(HoldoutNoiseRemark(problem_.records[1], train, train), "");
  EXPECT_EQ(HoldoutNoiseRemark(problem_.records[1], train, 1.25 * train),
            "Record 'holdout': noise relative to training, measured above the "
            "frequencies of the motion: a 1.25.");
}

}  // namespace
}  // namespace pinode
