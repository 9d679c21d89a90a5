#include "pinode/discover/smooth_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pinode/base/constants.h"
#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr double kStep = 0.02;
constexpr int kSamples = 300;

// x = 3 sin(2 t) + 0.5 cos(7 t), or a derivative of it.
double Motion(int derivative, double t) {
  const auto wave = [&](double amplitude, double omega, double phase) {
    return amplitude * std::pow(omega, derivative) *
           std::sin(omega * t + phase + derivative * kPi / 2.0);
  };
  return wave(3.0, 2.0, 0.0) + wave(0.5, 7.0, kPi / 2.0);
}

MotionChannel NoisyChannel(int derivative, double noise, uint64_t seed) {
  testing::Gaussian gaussian(seed);
  MotionChannel channel;
  channel.derivative = derivative;
  channel.values.resize(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    channel.values[i] = Motion(derivative, kStep * i) + noise * gaussian.Next();
  }
  return channel;
}

double AccelerationError(const SmoothedMotion& smoothed) {
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    sum += std::pow(smoothed.motion(2, i) - Motion(2, kStep * i), 2.0);
  }
  return std::sqrt(sum / kSamples);
}

TEST(SmoothMotion, KnowsHowWrongItIs) {
  SmoothedMotion smoothed;
  std::string error;
  int inside = 0;
  constexpr int kSeeds = 20;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const std::vector<MotionChannel> channels = {
        NoisyChannel(0, 0.02, 2 * static_cast<uint64_t>(seed)),
        NoisyChannel(1, 0.1, 2 * static_cast<uint64_t>(seed) + 1)};
    ASSERT_TRUE(SmoothMotion(kStep, channels, &smoothed, &error)) << error;
    EXPECT_NEAR(smoothed.noise[0], 0.02, 0.005);
    EXPECT_NEAR(smoothed.noise[1], 0.1, 0.02);
    const double said =
        smoothed.sigma.row(2).norm() / std::sqrt(static_cast<double>(kSamples));
    const double error_rms = AccelerationError(smoothed);
    EXPECT_LT(error_rms, 2.0);  // of an RMS of 19
    EXPECT_GT(error_rms, 0.2 * said);
    inside += error_rms < 1.5 * said;
  }
  EXPECT_GE(inside, 18);
}

TEST(SmoothMotion, TakesGivenNoiseAndGaps) {
  std::vector<MotionChannel> channels = {NoisyChannel(0, 0.02, 1),
                                         NoisyChannel(2, 0.5, 2)};
  channels[0].sigma = 0.02;
  for (int i = 50; i < 60; ++i) {
    channels[0].values[i] = std::numeric_limits<double>::quiet_NaN();
  }
  SmoothedMotion smoothed;
  std::string error;
  ASSERT_TRUE(SmoothMotion(kStep, channels, &smoothed, &error)) << error;
  EXPECT_EQ(smoothed.noise[0], 0.02);
  EXPECT_NEAR(smoothed.noise[1], 0.5, 0.1);
  EXPECT_LT(AccelerationError(smoothed), 0.5);
  for (int i = 50; i < 60; ++i) {
    EXPECT_NEAR(smoothed.motion(0, i), Motion(0, kStep * i), 0.05);
  }
}

TEST(SmoothMotion, OfNoiseFreeRecordsIsNearlyExact) {
  SmoothedMotion smoothed;
  std::string error;
  ASSERT_TRUE(SmoothMotion(kStep,
                           {NoisyChannel(0, 0.0, 1), NoisyChannel(1, 0.0, 1)},
                           &smoothed, &error))
      << error;
  EXPECT_LT(AccelerationError(smoothed), 0.01);
}

TEST(SmoothMotion, NeedsADisplacement) {
  SmoothedMotion smoothed;
  std::string error;
  EXPECT_FALSE(
      SmoothMotion(kStep, {NoisyChannel(2, 0.1, 1)}, &smoothed, &error));
  EXPECT_THAT(error, HasSubstr("displacement"));
  MotionChannel zero = NoisyChannel(0, 0.0, 1);
  zero.values.setZero();
  EXPECT_FALSE(SmoothMotion(kStep, {zero}, &smoothed, &error));
}

}  // namespace
}  // namespace pinode
