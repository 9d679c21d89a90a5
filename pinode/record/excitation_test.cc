#include "pinode/record/excitation.h"

#include <ceres/cubic_interpolation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/record/record.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

Matrix Samples() {
  Matrix samples(2, 6);
  samples << 1.0, -2.0, 4.0, 3.0, 0.5, 7.0,  //
      0.0, 1.0, 2.0, 3.0, 4.0, 5.0;
  return samples;
}

Vector At(const Excitation& excitation, Eigen::Index interval,
          double fraction) {
  Vector inputs(excitation.num_inputs());
  excitation.Evaluate(interval, fraction, inputs.data());
  return inputs;
}

TEST(ExcitationTest, HeldKeepsTheLeftSampleUpToTheRightEnd) {
  const Excitation excitation(2.0, 0.1, Samples(), Interpolation::kHeld);
  EXPECT_EQ(excitation.num_inputs(), 2);
  EXPECT_EQ(excitation.num_samples(), 6);
  EXPECT_DOUBLE_EQ(excitation.time(3), 2.3);
  for (const double fraction : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(At(excitation, 1, fraction), Samples().col(1));
  }
  EXPECT_EQ(At(excitation, 2, 0.0), Samples().col(2));
}

TEST(ExcitationTest, LinearIsAStraightLine) {
  const Excitation excitation(0.0, 0.1, Samples(), Interpolation::kLinear);
  EXPECT_EQ(At(excitation, 0, 0.0), Samples().col(0));
  EXPECT_EQ(At(excitation, 0, 1.0), Samples().col(1));
  EXPECT_DOUBLE_EQ(At(excitation, 1, 0.25)[0], -0.5);
  EXPECT_DOUBLE_EQ(At(excitation, 3, 0.5)[1], 3.5);
}

// A signal sampled five and two and a half times per period is reproduced with
// the error that the header states.
TEST(ExcitationTest, BandLimitedIsTheSampledSignal) {
  for (const double samples_per_period : {5.0, 2.5, 2.25}) {
    const int count = 400;
    const double omega = 2.0 * kPi / samples_per_period;
    Matrix samples(2, count);
    for (int i = 0; i < count; ++i) {
      samples.col(i) << std::sin(omega * i + 0.3), 3.0;
    }
    const Excitation excitation(0.0, 0.1, samples, Interpolation::kBandLimited);
    double worst = 0.0;
    for (int i = 32; i < count - 33; ++i) {
      for (const double fraction : {0.0, 0.125, 0.5, 0.9, 1.0}) {
        const Vector inputs = At(excitation, i, fraction);
        worst = std::max(
            worst,
            std::abs(inputs[0] - std::sin(omega * (i + fraction) + 0.3)));
        EXPECT_NEAR(inputs[1], 3.0, 1e-13);
      }
    }
    EXPECT_LT(worst, 2e-5) << samples_per_period;
  }
  // Near the ends it passes through the samples, and a line stays a line.
  const Excitation few(0.0, 0.1, Samples(), Interpolation::kBandLimited);
  EXPECT_EQ(At(few, 0, 0.0), Samples().col(0));
  EXPECT_EQ(At(few, 4, 1.0), Samples().col(5));
  EXPECT_NEAR(At(few, 2, 0.5)[1], 2.5, 1e-6);
  Interpolation parsed;
  ASSERT_TRUE(ParseInterpolation("band_limited", &parsed));
  EXPECT_EQ(parsed, Interpolation::kBandLimited);
}

TEST(ExcitationTest, CubicIsThatOfCeres) {
  const Matrix samples = Samples();
  const Excitation excitation(0.0, 0.1, samples, Interpolation::kCubic);
  using Grid = ceres::Grid1D<double, 2>;
  const Grid grid(samples.data(), 0, static_cast<int>(samples.cols()));
  const ceres::CubicInterpolator<Grid> interpolator(grid);
  for (int interval = 0; interval < 5; ++interval) {
    for (const double fraction : {0.0, 0.125, 0.5, 0.9, 1.0}) {
      Vector expected(2);
      interpolator.Evaluate(interval + fraction, expected.data());
      EXPECT_LT((At(excitation, interval, fraction) - expected).norm(), 1e-13)
          << interval << " + " << fraction;
    }
  }
}

TEST(ExcitationTest, CubicReproducesQuadraticsInside) {
  Matrix samples(1, 8);
  for (int i = 0; i < 8; ++i) samples(0, i) = 2.0 - i + 0.5 * i * i;
  const Excitation excitation(0.0, 1.0, samples, Interpolation::kCubic);
  for (int interval = 1; interval < 6; ++interval) {
    for (const double fraction : {0.1, 0.5, 0.8}) {
      const double t = interval + fraction;
      EXPECT_NEAR(At(excitation, interval, fraction)[0], 2.0 - t + 0.5 * t * t,
                  1e-13);
    }
  }
}

TEST(ExcitationTest, TheLastSampleHolds) {
  for (const Interpolation interpolation :
       {Interpolation::kHeld, Interpolation::kLinear, Interpolation::kCubic}) {
    const Excitation excitation(0.0, 0.1, Samples(), interpolation);
    EXPECT_EQ(At(excitation, 5, 0.7), Samples().col(5));
    EXPECT_EQ(At(excitation, 1000, 0.0), Samples().col(5));
    const Excitation single(0.0, 0.1, Samples().leftCols(1), interpolation);
    EXPECT_EQ(At(single, 0, 0.5), Samples().col(0));
    const Excitation none(0.0, 0.1, Matrix(0, 4), interpolation);
    none.Evaluate(1, 0.5, nullptr);
    EXPECT_EQ(none.num_inputs(), 0);
  }
}

// The first sample follows the last one, for all interpolations.
TEST(ExcitationTest, PeriodicGoesOnWithTheFirstSample) {
  const int count = 90;
  const double omega = 2.0 * kPi * 7.0 / count;
  Matrix samples(1, count), three(1, 3 * count);
  for (int i = 0; i < count; ++i) samples(0, i) = std::sin(omega * i + 0.3);
  three << samples, samples, samples;
  for (const Interpolation interpolation :
       {Interpolation::kHeld, Interpolation::kLinear, Interpolation::kCubic,
        Interpolation::kBandLimited}) {
    const Excitation one(0.0, 0.1, samples, interpolation, true);
    const Excitation longer(0.0, 0.1, three, interpolation);
    for (const int interval : {0, 1, 40, 88, 89}) {
      for (const double fraction : {0.0, 0.25, 1.0}) {
        EXPECT_NEAR(At(one, interval, fraction)[0],
                    At(longer, count + interval, fraction)[0], 1e-12);
      }
    }
    EXPECT_EQ(At(one, count, 0.0)[0], samples(0, 0));
  }
}

TEST(ExcitationTest, NamesOfInterpolations) {
  for (const Interpolation interpolation :
       {Interpolation::kHeld, Interpolation::kLinear, Interpolation::kCubic}) {
    Interpolation parsed = Interpolation::kHeld;
    EXPECT_TRUE(ParseInterpolation(InterpolationName(interpolation), &parsed));
    EXPECT_EQ(parsed, interpolation);
  }
  Interpolation parsed = Interpolation::kCubic;
  EXPECT_FALSE(ParseInterpolation("spline", &parsed));
  EXPECT_EQ(parsed, Interpolation::kCubic);
}

TEST(ExcitationTest, GapsAreRefused) {
  Record record;
  record.name = "quake";
  record.start_time = 1.0;
  record.sampling_step = 0.5;
  record.channels = {{"ag", "g", Vector::Ones(10)}};
  std::string error;
  EXPECT_TRUE(IsCompleteExcitation(record, record.channels[0], &error));
  Vector& values = record.channels[0].values;
  values[3] = values[4] = values[8] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(IsCompleteExcitation(record, record.channels[0], &error));
  EXPECT_THAT(error, HasSubstr("record 'quake': the excitation 'ag' misses 2 "
                               "samples from 2.5 to 3 (and more in 1 further"));
}

// More intervals than an int can count.
TEST(ExcitationTest, GoesOnForAnyNumberOfPeriods) {
  const Eigen::Index late = Eigen::Index{6} * 1000000000;
  for (const Interpolation interpolation :
       {Interpolation::kHeld, Interpolation::kLinear, Interpolation::kCubic,
        Interpolation::kBandLimited}) {
    const Excitation excitation(0.0, 0.125, Samples(), interpolation, true);
    for (int i = 0; i < 6; ++i) {
      for (const double fraction : {0.0, 0.3, 1.0}) {
        EXPECT_EQ(At(excitation, late + i, fraction),
                  At(excitation, i, fraction));
      }
    }
    EXPECT_EQ(excitation.time(late), 0.125 * 6e9);
  }
}

}  // namespace
}  // namespace pinode
