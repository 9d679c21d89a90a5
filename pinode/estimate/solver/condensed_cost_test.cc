#include "pinode/estimate/solver/condensed_cost.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

TEST(CondensedCost, KeepsCostGradientAndHessian) {
  for (int segment_samples : {0, 7}) {
    const testing::SmallFit fit(IdentificationRecord::Start::kFree);
    const auto objective =
        fit.Shoot(segment_samples, MultipleShooting::Options());
    CondensedSystem system;
    ASSERT_TRUE(objective->Linearize(fit.free, &system));

    const int n = static_cast<int>(fit.free.size());
    CondensedCost cost(objective.get(), n);
    ASSERT_EQ(cost.num_residuals(), n + 1);
    Vector residual(n + 1);
    RowMajorMatrix jacobian(n + 1, n);
    const double* parameters[] = {fit.free.data()};
    double* jacobians[] = {jacobian.data()};
    ASSERT_TRUE(cost.Evaluate(parameters, residual.data(), jacobians));
    EXPECT_NEAR(0.5 * residual.squaredNorm(), system.cost, 1e-12 * system.cost);
    EXPECT_LT((jacobian.transpose() * residual - system.gradient).norm(),
              1e-10 * system.gradient.norm());
    EXPECT_LT((jacobian.transpose() * jacobian - system.hessian).norm(),
              1e-11 * system.hessian.norm());

    Vector alone(n + 1);
    ASSERT_TRUE(cost.Evaluate(parameters, alone.data(), nullptr));
    EXPECT_NEAR(0.5 * alone.squaredNorm(), system.cost, 1e-12 * system.cost);
    EXPECT_EQ(cost.failed_evaluations(), 0);
    EXPECT_GT(cost.jacobian_seconds(), 0.0);

    // Parameters that are not finite are a failed evaluation, not a crash.
    const Vector nan =
        Vector::Constant(n, std::numeric_limits<double>::quiet_NaN());
    const double* bad[] = {nan.data()};
    EXPECT_FALSE(cost.Evaluate(bad, residual.data(), jacobians));
    EXPECT_EQ(cost.failed_evaluations(), 1);
  }
}

}  // namespace
}  // namespace pinode
