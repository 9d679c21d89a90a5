#include "pinode/estimate/shooting/shooting_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace pinode {
namespace {

const Vector kHere = Vector::Constant(2, 1.0);
const Vector kThere = Vector::Constant(2, 1.5);

ShootingLinearization LinearizationAt(const Vector& free) {
  ShootingLinearization result;
  result.free = free;
  result.starts = {Matrix::Zero(2, 1)};
  result.cost = 3.0;
  result.system.gradient = Vector::Zero(2);
  result.system.hessian = Matrix::Identity(2, 2);
  result.squares = std::vector<Vector>{Vector::Ones(1)};
  result.data_curvature = 7.0;
  return result;
}

ShootingState Linearized() {
  ShootingState state;
  state.SetCut({Matrix::Zero(2, 1)});
  state.SetTrajectory(kHere, 3.0, false);
  state.SetLinearization(LinearizationAt(kHere));
  return state;
}

TEST(ShootingState, EachLevelIncludesThoseBefore) {
  ShootingState state;
  EXPECT_FALSE(state.HasTrajectoryAt(Vector()));
  state.SetTrajectory(kHere, 3.0, false);
  EXPECT_TRUE(state.HasTrajectoryAt(kHere));
  EXPECT_FALSE(state.HasTrajectoryAt(kThere));
  EXPECT_FALSE(state.HasDerivatives());
  state.SetTrajectory(kHere, 3.0, true);
  EXPECT_TRUE(state.HasDerivatives());
  EXPECT_FALSE(state.HasSensitivitiesAt(kHere));
  state.SetLinearization(LinearizationAt(kHere));
  EXPECT_TRUE(state.HasTrajectoryAt(kHere));
  EXPECT_TRUE(state.HasSensitivitiesAt(kHere));
  EXPECT_FALSE(state.HasSensitivitiesAt(kThere));
  EXPECT_FALSE(state.HasDerivatives()) << "they are used up";
}

TEST(ShootingState, OtherPropagationsLeaveTheCost) {
  ShootingState state = Linearized();
  state.DropDerivatives();
  EXPECT_TRUE(state.HasTrajectoryAt(kHere));
  EXPECT_FALSE(state.HasSensitivitiesAt(kHere));
  state.SetNothing();
  state.DropDerivatives();
  EXPECT_FALSE(state.HasTrajectoryAt(kHere));
}

TEST(ShootingState, ATrialLeavesTheLinearization) {
  ShootingState state = Linearized();
  state.SetTrajectory(kThere, 2.0, false);
  EXPECT_FALSE(state.HasSensitivitiesAt(kHere));
  EXPECT_TRUE(state.HasTangent(2));
  EXPECT_FALSE(state.HasTangent(3));
  EXPECT_NE(state.SquaresAt(kHere), nullptr);
  EXPECT_EQ(state.SquaresAt(kThere), nullptr);
}

TEST(ShootingState, ChangesOfTheCostLeaveTheTangent) {
  ShootingState state = Linearized();
  state.SetCostChanged();
  EXPECT_FALSE(state.HasTrajectoryAt(kHere));
  EXPECT_TRUE(state.HasTangent(2));
  EXPECT_NE(state.SquaresAt(kHere), nullptr);
  EXPECT_TRUE(std::isinf(state.linearization().cost));
  state.SetCut({Matrix::Zero(2, 4)});
  EXPECT_FALSE(state.HasTangent(2));
  EXPECT_EQ(state.SquaresAt(kHere), nullptr);
  EXPECT_EQ(state.linearization().starts[0].cols(), 4);
  EXPECT_EQ(state.data_curvature(), 7.0);
}

TEST(ShootingState, EquationsThatAreNotFiniteFail) {
  ShootingState state = Linearized();
  EXPECT_FALSE(state.HasFailed());
  state.SetTrajectory(kThere, 2.0, true);
  ShootingLinearization broken = LinearizationAt(kThere);
  broken.system.gradient[0] = std::numeric_limits<double>::infinity();
  state.SetLinearization(std::move(broken));
  EXPECT_TRUE(state.HasFailed());
  EXPECT_FALSE(state.divergence().Happened());
  EXPECT_TRUE(state.HasTrajectoryAt(kThere));
  EXPECT_FALSE(state.HasSensitivitiesAt(kThere));
  EXPECT_TRUE(state.HasTangent(2));
  state.SetFailed({1, 2, 3, 0});
  EXPECT_TRUE(state.divergence().Happened());
  state.SetTrajectory(kHere, 3.0, false);
  EXPECT_FALSE(state.HasFailed());
  EXPECT_FALSE(state.divergence().Happened());
}

}  // namespace
}  // namespace pinode
