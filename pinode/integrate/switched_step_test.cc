#include "pinode/integrate/switched_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "pinode/integrate/free_run.h"
#include "pinode/integrate/segment.h"
#include "tests/support/bouncing_ball_testing.h"

namespace pinode {
namespace {

constexpr double kSamplingStep = 0.005;

Vector ClosedForm(const Vector& values, double time) {
  return testing::BallPath(values).At(time);
}

class BouncingBall : public ::testing::Test {
 protected:
  static constexpr int kSamples = 161;

  SegmentTangents Propagate(const StructuralDynamics& dynamics,
                            SegmentColumns columns, int substeps = 10) {
    StructuralDynamics::Prepared prepared;
    std::string error;
    EXPECT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
    const ObservationMap observation(
        dynamics, {{"x", Quantity::kDisplacement, Vector::Unit(1, 0)}});
    const IntegrationGrid grid(0.0, kSamplingStep, kSamples, substeps);
    SegmentPropagator propagator(dynamics, DerivativeMethod::kTangents);
    SegmentTangents result;
    EXPECT_TRUE(propagator.Propagate(prepared, observation, grid,
                                     Vector::Zero(2), 0, kSamples - 1, true,
                                     columns, &result));
    return result;
  }

  const Vector values_ = (Vector(3) << -9.0, 5000.0, 15.0).finished();
  const double time_ = kSamplingStep * (kSamples - 1);
};

TEST_F(BouncingBall, StepsKeepTheirOrder) {
  const Vector truth = ClosedForm(values_, time_);
  const auto ball = testing::MakeBall(values_);
  const auto error = [&](int substeps) {
    return (Propagate(*ball, SegmentColumns::kNone, substeps).end_state - truth)
        .norm();
  };
  EXPECT_LT(error(10), 1e-7);
  // Order four: plain steps across the jump have order one.
  const double rate = std::log2(error(2) / error(4));
  EXPECT_GT(rate, 3.5);
  EXPECT_LT(rate, 4.7);
}

// Contact of a sphere (Hertz): behind its switch the law has no value, and the
// step that leaves the contact is a plain one.
TEST_F(BouncingBall, LawsMayHaveNoValueBehindTheirSwitch) {
  const auto ball = testing::MakeMass(
      {{"1", values_[0]}, {"x[u] < -1 ? (-(x[u]+1))^1.5 : 0", values_[1]}});
  for (const int substeps : {1, 3, 10}) {
    const Vector state =
        Propagate(*ball, SegmentColumns::kNone, substeps).end_state;
    ASSERT_TRUE(state.allFinite()) << substeps;
    // Nothing dissipates. The whole energy is that of a fall by 1.
    const double energy = 0.5 * state[1] * state[1] - values_[0] * state[0];
    EXPECT_NEAR(energy, 0.0, 0.03 * -values_[0]) << substeps;
  }
}

TEST_F(BouncingBall, SensitivitiesGoThroughTheJumps) {
  const auto ball = testing::MakeBall(values_);
  const SegmentTangents tangents = Propagate(*ball, SegmentColumns::kAll);
  for (int p = 0; p < 3; ++p) {
    const double step = 1e-5 * std::abs(values_[p]);
    Vector more = values_;
    Vector less = values_;
    more[p] += step;
    less[p] -= step;
    const Vector slope =
        (ClosedForm(more, time_) - ClosedForm(less, time_)) / (2.0 * step);
    EXPECT_LT((tangents.end_sensitivity.col(2 + p) - slope).norm(),
              1e-5 * slope.norm())
        << p;
  }
  // The free run and the tangents go the same way.
  const SegmentTangents run = Propagate(*ball, SegmentColumns::kNone);
  EXPECT_LT((run.channels - tangents.channels).norm(), 1e-12);
}

TEST(SwitchedStep, FrictionThatSticksIsAPlainStep) {
  // Dry friction brings the mass to rest, where the sign has no branch that
  // leads through zero.
  const auto mass = testing::MakeMass({{"-sign(v[u])", 2.0}});
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(mass->Prepare(mass->Parameters(), &prepared, &error));
  const ObservationMap observation(
      *mass, {{"v", Quantity::kVelocity, Vector::Unit(1, 0)}});
  const IntegrationGrid grid(0.0, 0.01, 101, 1);
  Trajectory trajectory;
  Vector start(2);
  start << 0.0, 1.0;
  ASSERT_TRUE(
      FreeRun(*mass, prepared, observation, grid, start, 0, 100, &trajectory));
  // It stops after 0.5 s and 0.25.
  EXPECT_NEAR(trajectory.channels(0, 25), 0.5, 1e-12);
  EXPECT_NEAR(trajectory.channels(0, 100), 0.0, 0.02);
  EXPECT_NEAR(trajectory.states(0, 100), 0.25, 0.01);
}

TEST(SwitchedStep, LinearMotionHasNoPieces) {
  const auto spring = testing::MakeMass({{"-x[u]", 4.0}});
  EXPECT_EQ(spring->num_switches(), 0);
  EXPECT_EQ(testing::MakeBall((Vector(3) << -9.0, 1.0, 1.0).finished())
                ->num_switches(),
            2);
}

}  // namespace
}  // namespace pinode
