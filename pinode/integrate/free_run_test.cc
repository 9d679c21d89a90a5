#include "pinode/integrate/free_run.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/dynamics_testing.h"

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

// Long runs of linear dynamics use modes, short ones use steps.
TEST(FreeRun, LongRunsEqualShortOnesOneAfterTheOther) {
  for (const double damping : {0.0, 0.3, 20.0}) {
    const StructuralDynamics dynamics(
        testing::MakeChain(3, 10.0, damping),
        {{InputSpec::Kind::kGroundAcceleration, 0, "ag"},
         {InputSpec::Kind::kForce, 1, "f"}});
    StructuralDynamics::Prepared prepared;
    std::string error;
    ASSERT_TRUE(dynamics.Prepare(Vector(), &prepared, &error)) << error;
    const ObservationMap observation(
        dynamics, {{"x", Quantity::kDisplacement, Vector::Unit(3, 1)},
                   {"a", Quantity::kAbsoluteAcceleration, Vector::Unit(3, 2)}});
    constexpr int kSamples = 601;
    Matrix input(2, kSamples);
    for (int i = 0; i < kSamples; ++i) {
      input.col(i) << std::sin(0.7 * i), std::cos(0.2 * i);
    }
    const IntegrationGrid grid(
        Excitation(0.0, 0.05, input, Interpolation::kCubic), 2);
    Vector start = Vector::LinSpaced(6, -1.0, 1.0);
    Trajectory whole;
    ASSERT_TRUE(FreeRun(dynamics, prepared, observation, grid, start, 0,
                        kSamples - 1, &whole));
    // Modes and steps give the same result, whatever is stored.
    for (const int last : {kSamples - 1, 20}) {
      Trajectory channels;
      ASSERT_TRUE(FreeRun(dynamics, prepared, observation, grid, start, 0, last,
                          &channels, Keep::kChannels));
      EXPECT_EQ(channels.num_samples(), last + 1);
      EXPECT_LT((channels.channels - whole.channels.leftCols(last + 1)).norm(),
                1e-11);
      EXPECT_EQ(channels.states.cols(), 1);
      EXPECT_LT((channels.states - whole.states.col(last)).norm(), 1e-11);
    }
    for (int first = 0; first < kSamples - 1; first += 10) {
      Trajectory part;
      ASSERT_TRUE(FreeRun(dynamics, prepared, observation, grid, start, first,
                          first + 10, &part));
      EXPECT_LT((part.states - whole.states.middleCols(first, 11))
                    .cwiseAbs()
                    .maxCoeff(),
                1e-11);
      EXPECT_LT((part.channels - whole.channels.middleCols(first, 11))
                    .cwiseAbs()
                    .maxCoeff(),
                1e-11);
      start = part.states.rightCols(1);
    }
  }
}

// Threads share a long run. The choice of stored results does not change it.
// Mean squares are those of every `stride`th sample.
void ExpectSameBitsOfThreads(int num_samples, int stride) {
  const StructuralDynamics dynamics(
      testing::MakeChain(3, 10.0, 0.3),
      {{InputSpec::Kind::kGroundAcceleration, 0, "ag"}});
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics.Prepare(Vector(), &prepared, &error)) << error;
  const ObservationMap observation(
      dynamics, {{"a", Quantity::kAbsoluteAcceleration, Vector::Unit(3, 2)}});
  Matrix input(1, num_samples);
  for (int i = 0; i < num_samples; ++i) {
    input(0, i) = std::sin(0.7 * i) + std::cos(0.011 * i * std::sqrt(i));
  }
  const IntegrationGrid grid = IntegrationGrid::Exact(
      Excitation(0.0, 0.05, input, Interpolation::kLinear));
  const Vector start = Vector::LinSpaced(6, -1.0, 1.0);
  const auto run = [&](Keep keep, int threads) {
    Trajectory trajectory;
    EXPECT_TRUE(FreeRun(dynamics, prepared, observation, grid, start, 0,
                        num_samples - 1, &trajectory, keep, threads));
    return trajectory;
  };
  const Trajectory one = run(Keep::kAll, 1);
  const Matrix some =
      one.states(Eigen::all, Eigen::seq(0, num_samples - 1, stride));
  const Vector mean_squares =
      some.rowwise().squaredNorm() / static_cast<double>(some.cols());
  for (const int threads : {1, 2, 3}) {
    const Trajectory all = run(Keep::kAll, threads);
    EXPECT_EQ(all.channels, one.channels);
    EXPECT_EQ(all.states, one.states);
    const Trajectory few = run(Keep::kMeanSquares, threads);
    EXPECT_EQ(few.channels, one.channels);
    EXPECT_EQ(few.mean_squares, run(Keep::kMeanSquares, 1).mean_squares);
    EXPECT_LT((few.mean_squares - mean_squares).norm(),
              1e-13 * mean_squares.norm());
    EXPECT_EQ(run(Keep::kChannels, threads).channels, one.channels);
  }
}

TEST(FreeRun, ThreadsFindTheSameBits) {
  ExpectSameBitsOfThreads(9000, 1);
  ExpectSameBitsOfThreads(50001, 3);
}

TEST(FreeRun, LongRunsEndWhereTheyRunAway) {
  StructuralModel model = testing::MakeChain(2, 1.0, 0.0);
  model.stiffness *= -1e3;
  const StructuralDynamics dynamics(model, {});
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics.Prepare(Vector(), &prepared, &error)) << error;
  const ObservationMap observation(
      dynamics, {{"x", Quantity::kDisplacement, Vector::Unit(2, 0)}});
  const IntegrationGrid grid(0.0, 0.05, 2000, 4);
  Trajectory trajectory;
  EXPECT_FALSE(FreeRun(dynamics, prepared, observation, grid, Vector::Ones(4),
                       0, 1999, &trajectory));
  const Eigen::Index failed = trajectory.failed_sample;
  ASSERT_GT(failed, 10);
  ASSERT_LT(failed, 1999);
  EXPECT_GE(trajectory.failed_state, 0);
  EXPECT_LT(trajectory.states.leftCols(failed).cwiseAbs().maxCoeff(), 1e100);
  EXPECT_TRUE(trajectory.states.rightCols(2000 - failed).array().isNaN().all());
  EXPECT_TRUE(
      trajectory.channels.rightCols(2000 - failed).array().isNaN().all());
  Trajectory channels;
  EXPECT_FALSE(FreeRun(dynamics, prepared, observation, grid, Vector::Ones(4),
                       0, 1999, &channels, Keep::kChannels));
  EXPECT_EQ(channels.failed_sample, failed);
  EXPECT_EQ(channels.failed_state, trajectory.failed_state);
}

}  // namespace
}  // namespace pinode
