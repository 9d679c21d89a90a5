#include "pinode/estimate/objective/bent_cost.h"

#include <Eigen/LU>
#include <cmath>

#include "gtest/gtest.h"

namespace pinode {
namespace {

// r = (10 (x2 - x1^2), 1 - x1), a valley along x2 = x1^2.
class BentValley final : public CostPart {
 public:
  static Vector Residuals(const Vector& x) {
    return Eigen::Vector2d(10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]);
  }
  static Matrix Jacobian(const Vector& x) {
    Matrix jacobian(2, 2);
    jacobian << -20.0 * x[0], 10.0, -1.0, 0.0;
    return jacobian;
  }
  bool Evaluate(const Vector& x, double* cost) override {
    *cost = 0.5 * Residuals(x).squaredNorm();
    return std::isfinite(*cost);
  }
  bool Linearize(const Vector& x, CondensedSystem* system) override {
    at = x;
    const Matrix jacobian = Jacobian(x);
    system->gradient = jacobian.transpose() * Residuals(x);
    system->hessian = jacobian.transpose() * jacobian;
    return Evaluate(x, &system->cost);
  }
  std::string Failure() const override { return ""; }

  // The only second derivative is that of the first residual by x1.
  Vector Bend(const Vector& step) const {
    return Jacobian(at).transpose() *
           Eigen::Vector2d(-20.0 * step[0] * step[0], 0.0);
  }
  Vector at;
};

class BentCostTest : public ::testing::Test {
 protected:
  BentCostTest()
      : bent_(
            &valley_,
            [this](const Vector& step, Vector* projected) {
              *projected = valley_.Bend(step);
              return can_bend_;
            },
            &radius_) {
    EXPECT_TRUE(bent_.Linearize(start_, &system_));
  }

  Vector PointAt(const Vector& flat) {
    double cost = 0.0;
    EXPECT_TRUE(bent_.Evaluate(flat, &cost));
    return bent_.PointOf(flat);
  }

  BentValley valley_;
  double radius_ = 1e12;
  bool can_bend_ = true;
  BentCost bent_;
  const Vector start_ = Eigen::Vector2d(-1.0, 1.0);
  CondensedSystem system_;
};

// Undamped, and with as many residuals as unknowns, the residuals change along
// the path as if they were linear; here there is no third derivative either.
TEST_F(BentCostTest, ResidualsAreStraightAlongThePath) {
  const Vector step = Eigen::Vector2d(0.1, -0.2);
  const Vector point = PointAt(start_ + step);
  const Vector straight =
      BentValley::Residuals(start_) + BentValley::Jacobian(start_) * step;
  EXPECT_LT((BentValley::Residuals(point) - straight).norm(), 1e-9);
  EXPECT_GT((BentValley::Residuals(start_ + step) - straight).norm(), 0.09);
}

// The damping of the step is that of its bend.
TEST_F(BentCostTest, BendIsDamped) {
  radius_ = 0.5;
  const Vector step = Eigen::Vector2d(0.01, -0.02);
  Matrix damped = system_.hessian;
  damped.diagonal() *= 3.0;
  const Vector bend = -damped.inverse() * valley_.Bend(step);
  const Vector point = PointAt(start_ + step);
  EXPECT_LT((point - start_ - step - 0.5 * bend).norm(), 1e-12 * bend.norm());
}

// 2 |a| = 3/4 |d| at most, in units of the diagonal.
TEST_F(BentCostTest, BendIsShortened) {
  const Vector step = Eigen::Vector2d(1.9, 0.3);
  const Vector bend = 2.0 * (PointAt(start_ + step) - start_ - step);
  const Vector diagonal = system_.hessian.diagonal();
  EXPECT_NEAR(2.0 * std::sqrt(bend.cwiseAbs2().dot(diagonal)),
              0.75 * std::sqrt(step.cwiseAbs2().dot(diagonal)), 1e-9);
}

// The others bend as if they were alone.
TEST_F(BentCostTest, WhatIsHeldStays) {
  const auto bend = [this](const Vector& along, Vector* projected) {
    *projected = valley_.Bend(along);
    return true;
  };
  CondensedSystem system;
  double cost = 0.0;
  BentCost first_held(&valley_, bend, &radius_, 0);
  ASSERT_TRUE(first_held.Linearize(start_, &system));
  const Vector up = start_ + Vector(Eigen::Vector2d(0.0, 0.1));
  ASSERT_TRUE(first_held.Evaluate(up, &cost));
  EXPECT_EQ(first_held.PointOf(up), up) << "along x2 alone nothing bends";

  BentCost second_held(&valley_, bend, &radius_, 1);
  ASSERT_TRUE(second_held.Linearize(start_, &system));
  const Vector right = start_ + Vector(Eigen::Vector2d(0.1, 0.0));
  ASSERT_TRUE(second_held.Evaluate(right, &cost));
  const Vector point = second_held.PointOf(right);
  EXPECT_EQ(point[1], start_[1]);
  const double alone = -valley_.Bend(right - start_)[0] / system.hessian(0, 0);
  EXPECT_NEAR(point[0], right[0] + 0.5 * alone, 1e-9 * std::abs(alone));
}

TEST_F(BentCostTest, StraightWhereTheBendIsNotKnown) {
  can_bend_ = false;
  const Vector step = Eigen::Vector2d(0.1, -0.2);
  EXPECT_EQ(PointAt(start_ + step), start_ + step);
}

// After a step the next path begins at its end; ends of earlier ones are known.
TEST_F(BentCostTest, PathsFollowEachOther) {
  const Vector first = start_ + Vector(Eigen::Vector2d(0.1, -0.2));
  const Vector refused = start_ + Vector(Eigen::Vector2d(0.3, 0.0));
  PointAt(refused);
  const Vector point = PointAt(first);
  CondensedSystem there;
  ASSERT_TRUE(bent_.Linearize(first, &there));
  EXPECT_EQ(valley_.at, point);
  CondensedSystem own;
  ASSERT_TRUE(valley_.Linearize(point, &own));
  EXPECT_EQ(there.gradient, own.gradient);

  const Vector second = first + Vector(Eigen::Vector2d(0.05, -0.1));
  const Vector end = PointAt(second);
  EXPECT_NE(end - point, second - first);
  EXPECT_EQ(bent_.PointOf(start_), start_);
  EXPECT_EQ(bent_.PointOf(first), point);
}

}  // namespace
}  // namespace pinode
