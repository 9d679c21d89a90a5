#include "pinode/record/resample.h"

#include <cmath>
#include <limits>

#include "gtest/gtest.h"
#include "pinode/base/constants.h"

namespace pinode {
namespace {

Vector Sine(double frequency, double step, int num_samples) {
  Vector values(num_samples);
  for (int i = 0; i < num_samples; ++i) {
    values[i] = std::sin(2.0 * kPi * frequency * step * i + 0.3);
  }
  return values;
}

// Largest error away from the ends.
double InnerError(const Vector& a, const Vector& b) {
  EXPECT_EQ(a.size(), b.size());
  const Eigen::Index margin = a.size() / 4;
  return (a - b)
      .segment(margin, a.size() - 2 * margin)
      .lpNorm<Eigen::Infinity>();
}

TEST(ResampleTest, KeepsTheSameRateAsItIs) {
  const Vector values = Sine(3.0, 0.01, 100);
  EXPECT_EQ(Resample(values, 0.01, 0.01), values);
}

TEST(ResampleTest, ToAHigherRate) {
  // 4 s at 100 Hz; 130 Hz has no simple ratio to it.
  for (const double new_rate : {130.0, 200.0, 1000.0}) {
    for (const double frequency : {0.7, 5.0, 20.0, 40.0}) {
      const Vector values = Sine(frequency, 0.01, 401);
      const Vector resampled = Resample(values, 0.01, 1.0 / new_rate);
      const Vector expected = Sine(frequency, 1.0 / new_rate,
                                   static_cast<int>(4.0 * new_rate + 1.5));
      EXPECT_LT(InnerError(resampled, expected), 1e-3)
          << new_rate << " " << frequency;
    }
  }
  // Old samples are kept.
  const Vector values = Sine(5.0, 0.01, 101);
  const Vector twice = Resample(values, 0.01, 0.005);
  ASSERT_EQ(twice.size(), 201);
  for (int i = 0; i <= 100; ++i) EXPECT_NEAR(twice[2 * i], values[i], 1e-12);
}

TEST(ResampleTest, ToALowerRateKeepsTheBandAndStopsWhatWouldFold) {
  const double step = 0.001;
  for (const double new_rate : {250.0, 100.0, 93.0}) {
    const double new_nyquist = 0.5 * new_rate;
    const int n = 8001;
    for (const double fraction : {0.05, 0.5, 0.8}) {
      const double frequency = fraction * new_nyquist;
      const Vector resampled =
          Resample(Sine(frequency, step, n), step, 1.0 / new_rate);
      const Vector expected =
          Sine(frequency, 1.0 / new_rate, static_cast<int>(resampled.size()));
      EXPECT_LT(InnerError(resampled, expected), 2e-3)
          << new_rate << " " << fraction;
    }
    for (const double fraction : {1.05, 1.5, 1.97}) {
      const Vector resampled =
          Resample(Sine(fraction * new_nyquist, step, n), step, 1.0 / new_rate);
      EXPECT_LT(InnerError(resampled, Vector::Zero(resampled.size())), 1e-3)
          << new_rate << " " << fraction;
    }
  }
}

TEST(ResampleTest, ConstantsAndEnds) {
  const Vector constant = Vector::Constant(100, 2.5);
  for (const double new_step : {0.003, 0.01 / 3.0, 0.037}) {
    const Vector resampled = Resample(constant, 0.01, new_step);
    EXPECT_LT((resampled.array() - 2.5).abs().maxCoeff(), 1e-12);
    // Covers the old span and no more.
    const double end = static_cast<double>(resampled.size() - 1) * new_step;
    EXPECT_LE(end, 0.99 + 1e-9);
    EXPECT_GT(end + new_step, 0.99);
  }
  // Odd reflection keeps a line straight up to its ends.
  const Vector line = Vector::LinSpaced(101, 0.0, 1.0);
  const Vector finer = Resample(line, 0.01, 0.0025);
  EXPECT_LT(
      (finer - Vector::LinSpaced(401, 0.0, 1.0)).lpNorm<Eigen::Infinity>(),
      1e-4);
}

// NumPy gave the figures, from the definition: the sum of sinc(b d) w(d / r)
// over the samples at distances d up to r = 32 / b, with b = 0.92 / ratio,
// Blackman's window w and odd reflection at the ends.
TEST(ResampleTest, IsTheWindowedSincOfItsDefinition) {
  Vector values(301);
  for (int i = 0; i < 301; ++i) values[i] = std::cos(0.01 * i * i);
  const Vector half = Resample(values, 0.01, 0.02);
  EXPECT_NEAR(half[0], 1.000000000000, 1e-9);
  EXPECT_NEAR(half[40], 0.257187578905, 1e-9);
  EXPECT_NEAR(half[75], -0.000046324470, 1e-9);
  EXPECT_NEAR(half[150], 0.066246702203, 1e-9);
  // The fraction of the time changes from sample to sample.
  const Vector other = Resample(values, 0.01, 0.0137);
  EXPECT_NEAR(other[3], 0.985764289029, 1e-9);
  EXPECT_NEAR(other[120], -0.000916141710, 1e-9);
}

TEST(ResampleTest, OneSampleIsLeft) {
  for (const double step : {0.4, 1e6, 1e300}) {
    EXPECT_EQ(Resample(Sine(3.0, 0.01, 40), 0.01, step), Sine(3.0, 0.01, 1));
  }
}

TEST(ResampleTest, MissingSamplesStayMissing) {
  Vector values = Sine(2.0, 0.01, 401);
  for (int i = 200; i < 210; ++i) {
    values[i] = std::numeric_limits<double>::quiet_NaN();
  }
  const Vector finer = Resample(values, 0.01, 0.004);
  const Vector expected = Sine(2.0, 0.004, static_cast<int>(finer.size()));
  for (int i = 0; i < finer.size(); ++i) {
    const double t = 0.004 * i;
    const bool missing = t > 1.99 + 1e-9 && t < 2.10 - 1e-9;
    EXPECT_EQ(std::isnan(finer[i]), missing) << t;
    if (t > 0.4 && t < 1.6) {
      EXPECT_NEAR(finer[i], expected[i], 1e-3);
    }
  }
  const Vector nothing =
      Vector::Constant(11, std::numeric_limits<double>::quiet_NaN());
  const Vector still_nothing = Resample(nothing, 0.1, 0.2);
  EXPECT_EQ(still_nothing.size(), 6);
  EXPECT_TRUE(still_nothing.array().isNaN().all());
}

TEST(ResampleTest, Records) {
  Record record;
  record.name = "r";
  record.start_time = 5.0;
  record.sampling_step = 0.01;
  record.channels = {{"a", "m/s^2", Sine(1.0, 0.01, 101)},
                     {"b", "g", Sine(2.0, 0.01, 101)}};
  const Record resampled = ResampleRecord(record, 0.02);
  EXPECT_EQ(resampled.start_time, 5.0);
  EXPECT_EQ(resampled.sampling_step, 0.02);
  EXPECT_EQ(resampled.num_samples(), 51);
  EXPECT_EQ(resampled.channels[1].unit, "g");
  EXPECT_NEAR(resampled.duration(), record.duration(), 1e-12);
}

}  // namespace
}  // namespace pinode
