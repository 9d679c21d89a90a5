#include "pinode/estimate/objective/prior_cost.h"

#include <gtest/gtest.h>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// As a residual block and as a part it is one cost.
TEST(PriorCost, ResidualsHaveItsGradientAndHessian) {
  const testing::SmallFit fit(IdentificationRecord::Start::kFree);
  PriorCost priors(*fit.layout);
  priors.SetDecays(fit.decays);
  const int n = fit.layout->num_free();
  const int m = priors.num_residuals();
  ASSERT_GT(m, static_cast<int>(fit.layout->decay_rows().size()));
  Vector residuals(m);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>
      jacobian(m, n);
  const double* parameters[] = {fit.free.data()};
  double* jacobians[] = {jacobian.data()};
  ASSERT_TRUE(priors.Evaluate(parameters, residuals.data(), jacobians));
  CondensedSystem system;
  ASSERT_TRUE(priors.Linearize(fit.free, &system));
  EXPECT_GT(system.cost, 0.0);
  EXPECT_NEAR(0.5 * residuals.squaredNorm(), system.cost, 1e-14 * system.cost);
  EXPECT_LT((jacobian.transpose() * residuals - system.gradient).norm(),
            1e-13 * system.gradient.norm());
  EXPECT_LT((jacobian.transpose() * jacobian - system.hessian).norm(),
            1e-13 * system.hessian.norm());
  double cost = 0.0;
  ASSERT_TRUE(priors.Evaluate(fit.free, &cost));
  EXPECT_EQ(cost, system.cost);
}

TEST(PriorCost, IsNoneWithoutPriors) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(2, 10.0, 0.1);
  const ParameterLayout layout(problem);
  EXPECT_EQ(PriorCost(layout).num_priors(), 0);
}

}  // namespace
}  // namespace pinode
