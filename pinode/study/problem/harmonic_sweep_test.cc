#include "pinode/study/problem/harmonic_sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr double kStiffness = 4.0;
constexpr double kDamping = 0.1;

// A mass on a spring under ground motion, whose time is in milliseconds. Its
// sensors are of gain 2 and show hundredths.
IdentificationProblem GroundMotion() {
  using Kind = InputSpec::Kind;
  IdentificationProblem problem;
  problem.dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(1, kStiffness, kDamping),
      std::vector<InputSpec>{{Kind::kGroundAcceleration, 0, "ground_x"},
                             {Kind::kGroundDisplacement, 0, "moved"}});
  problem.description.units.time = "ms";
  Parameter gain;
  gain.name = "gain";
  gain.value = 2.0;
  problem.sensors.parameters.push_back(gain);
  IdentificationRecord record;
  record.name = "sweep";
  record.excitation =
      Excitation(0.0, 0.1, Matrix::Zero(2, 4), Interpolation::kLinear);
  for (const Quantity quantity :
       {Quantity::kDisplacement, Quantity::kAbsoluteDisplacement,
        Quantity::kAbsoluteAcceleration}) {
    MeasuredChannel channel;
    channel.observation = {QuantityName(quantity), quantity, Vector::Ones(1)};
    channel.gain = 0;
    channel.description.factor = 0.01;
    record.channels.push_back(std::move(channel));
  }
  problem.records.push_back(std::move(record));
  return problem;
}

HarmonicLoad SomeLoad() {
  HarmonicLoad load;
  load.input = "ground_x";
  load.amplitude = 3.0;
  load.from_hz = 100.0;
  load.to_hz = 800.0;
  load.num_points = 12;
  return load;
}

TEST(HarmonicSweep, OfGroundMotionIsTheFrequencyResponse) {
  const IdentificationProblem problem = GroundMotion();
  std::vector<SweepPoint> points;
  std::string error;
  ASSERT_TRUE(SweepRecord(problem, 0, ParameterLayout(problem).InitialValues(),
                          SomeLoad(), {}, &points, &error))
      << error;
  EXPECT_NEAR(points.front().frequency_hz, 100.0, 1e-9);
  EXPECT_NEAR(points.back().frequency_hz, 800.0, 1e-9);
  for (const SweepPoint& point : points) {
    const double w = kTwoPi * point.frequency_hz / 1000.0;
    const std::complex<double> relative =
        -3.0 / std::complex<double>(kStiffness - w * w, kDamping * w);
    const std::complex<double> expected[] = {relative, relative - 3.0 / (w * w),
                                             3.0 - w * w * relative};
    for (int c = 0; c < 3; ++c) {
      const std::complex<double> value = 2.0 / 0.01 * expected[c];
      EXPECT_NEAR(point.amplitude[c], std::abs(value), 1e-9 * std::abs(value));
      EXPECT_NEAR(std::remainder(point.phase[c] - std::arg(value), kTwoPi), 0.0,
                  1e-9);
      EXPECT_NEAR(point.half_range[c], std::abs(value), 1e-4 * std::abs(value));
    }
    EXPECT_FALSE(point.IsUnstable());
  }
}

TEST(HarmonicSweep, EndsWhenItIsToldAndRefusesOtherLoads) {
  const IdentificationProblem problem = GroundMotion();
  const Vector parameters = ParameterLayout(problem).InitialValues();
  std::vector<SweepPoint> points;
  std::string error;
  int calls = 0;
  EXPECT_TRUE(SweepRecord(
      problem, 0, parameters, SomeLoad(),
      [&calls](double) { return ++calls < 3; }, &points, &error));
  EXPECT_EQ(points.size(), 3u);
  HarmonicLoad load = SomeLoad();
  load.input = "moved";
  EXPECT_FALSE(SweepRecord(problem, 0, parameters, load, {}, &points, &error));
  EXPECT_THAT(error, HasSubstr("the case has 'ground_x'"));
  load = SomeLoad();
  load.amplitude = -1.0;
  EXPECT_FALSE(SweepRecord(problem, 0, parameters, load, {}, &points, &error));
  EXPECT_THAT(error, HasSubstr("expected a positive number"));
  load = SomeLoad();
  load.to_hz = load.from_hz;
  EXPECT_FALSE(SweepRecord(problem, 0, parameters, load, {}, &points, &error));
  EXPECT_THAT(error, HasSubstr("two different"));
}

}  // namespace
}  // namespace pinode
