#include "pinode/integrate/free_run.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/dynamics/testing.h"

namespace pinode {
namespace {

// One mass under ground acceleration that ramps linearly, a_g = t: the closed
// form of x'' + omega^2 x = -t from rest is (sin(omega t) / omega - t) /
// omega^2.
TEST(FreeRun, MatchesTheClosedFormUnderARamp) {
  constexpr double kStiffness = 25.0;
  const StructuralDynamics dynamics(
      testing::MakeChain(1, kStiffness, 0.0),
      {{InputSpec::Kind::kGroundAcceleration, 0, "ag"}});
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics.Prepare(Vector(), &prepared, &error)) << error;
  const ObservationMap observation(
      dynamics, {{"x", Quantity::kDisplacement, Vector::Ones(1)},
                 {"a", Quantity::kAbsoluteAcceleration, Vector::Ones(1)}});
  const int samples = 101;
  const Matrix ramp = RowVector::LinSpaced(samples, 0.0, 1.0);
  const IntegrationGrid grid(
      Excitation(0.0, 0.01, ramp, Interpolation::kLinear), 4);
  Trajectory trajectory;
  ASSERT_TRUE(FreeRun(dynamics, prepared, observation, grid, Vector::Zero(2), 0,
                      samples - 1, &trajectory));
  const double omega = std::sqrt(kStiffness);
  for (int i = 0; i < samples; ++i) {
    const double t = 0.01 * i;
    const double x = (std::sin(omega * t) / omega - t) / kStiffness;
    EXPECT_NEAR(trajectory.channels(0, i), x, 1e-10);
    // Absolute acceleration of an undamped mass is -omega^2 x.
    EXPECT_NEAR(trajectory.channels(1, i), -kStiffness * x, 1e-9);
  }
}

TEST(FreeRun, StartsAndEndsWhereToldTo) {
  const StructuralDynamics dynamics(testing::MakeChain(1, 1.0, 0.1), {});
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics.Prepare(Vector(), &prepared, &error)) << error;
  const ObservationMap observation(
      dynamics, {{"x", Quantity::kDisplacement, Vector::Ones(1)}});
  const IntegrationGrid grid(0.0, 0.1, 50, 2);
  Vector start(2);
  start << 1.0, -0.5;
  Trajectory whole, rest;
  ASSERT_TRUE(
      FreeRun(dynamics, prepared, observation, grid, start, 0, 49, &whole));
  ASSERT_TRUE(FreeRun(dynamics, prepared, observation, grid,
                      whole.states.col(20), 20, 49, &rest));
  EXPECT_EQ(rest.num_samples(), 30);
  EXPECT_EQ(rest.states, whole.states.rightCols(30));
}

}  // namespace
}  // namespace pinode
