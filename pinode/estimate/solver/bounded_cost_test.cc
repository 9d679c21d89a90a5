#include "pinode/estimate/solver/bounded_cost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "pinode/estimate/solver/optimality.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// f = |A x - b|^2 / 2.
class LinearCost final : public CostPart {
 public:
  LinearCost(Matrix a, Vector b) : a_(std::move(a)), b_(std::move(b)) {}

  bool Evaluate(const Vector& free, double* cost) override {
    *cost = 0.5 * (a_ * free - b_).squaredNorm();
    return true;
  }
  bool Linearize(const Vector& free, CondensedSystem* system) override {
    ++num_linearizations;
    const Vector r = a_ * free - b_;
    *system = {0.5 * r.squaredNorm(), a_.transpose() * r, a_.transpose() * a_};
    return true;
  }
  std::string Failure() const override { return ""; }

  int num_linearizations = 0;

 private:
  Matrix a_;
  Vector b_;
};

TEST(BoundedCost, IsFreeOfUnitsAndLosesNothing) {
  IdentificationProblem problem;  // three groups
  problem.dynamics = testing::MakeGroupedChain(3, 40.0, 0.1);
  const ParameterLayout layout(problem);
  const Matrix a = testing::Gaussian(3).Draw(5, 3);
  const Vector b = testing::Gaussian(4).Draw(5);
  const Vector start = testing::Gaussian(5).Draw(3);
  for (const double unit : {1.0, 8192.0, 1e-4}) {
    LinearCost part(a / unit, b);
    BoundedCost cost(layout, unit * start, &part);
    ASSERT_TRUE(cost.IsValid());
    const Vector scaled = cost.Scaled(unit * start);
    EXPECT_EQ(cost.Unscaled(scaled), unit * start);
    CondensedSystem system;
    ASSERT_TRUE(cost.Linearize(scaled, &system));
    EXPECT_EQ(part.num_linearizations, 1) << "the same point again";
    for (int j = 0; j < 3; ++j) {
      const double norm = std::sqrt(system.hessian(j, j));
      EXPECT_GT(norm, 0.5 * 1048576.0);
      EXPECT_LE(norm, 1048576.0);
    }
    double value = 0.0;
    ASSERT_TRUE(cost.Evaluate(scaled, &value));
    EXPECT_NEAR(value, system.cost, 1e-14 * value);
  }
}

TEST(Optimality, SeesAMinimumAndAHalt) {
  const testing::SmallFit fit(IdentificationRecord::Start::kFree);
  const auto objective = fit.Shoot(0, MultipleShooting::Options());
  CondensedSystem system;
  ASSERT_TRUE(objective->Linearize(fit.free, &system));
  const Optimality here = MeasureOptimality(*fit.layout, fit.free, system);
  EXPECT_GT(here.cosine, 1e-3);
  EXPECT_GT(here.promise, 1e-3);
  EXPECT_TRUE(here.IsStalled(system.cost, system.cost));
  EXPECT_FALSE(here.IsStalled(1e-12 * system.cost, system.cost)) << "rounding";
  system.gradient.setZero();
  const Optimality minimum = MeasureOptimality(*fit.layout, fit.free, system);
  EXPECT_EQ(minimum.cosine, 0.0);
  EXPECT_EQ(minimum.promise, 0.0);
  EXPECT_FALSE(minimum.IsStalled(system.cost, system.cost));
}

TEST(Optimality, HoldsWhatWouldLeaveItsBounds) {
  Parameter parameter;
  parameter.lower = -1.0;
  parameter.upper = 1.0;
  EXPECT_TRUE(IsHeldAtBound(parameter, -1.0, 0.1));
  EXPECT_FALSE(IsHeldAtBound(parameter, -1.0, -0.1));
  EXPECT_TRUE(IsHeldAtBound(parameter, 1.0, -0.1));
  EXPECT_FALSE(IsHeldAtBound(parameter, 0.5, -0.1));
}

}  // namespace
}  // namespace pinode
