#include "pinode/discover/robust_fit.h"

#include <gtest/gtest.h>

#include <string>

#include "pinode/discover/least_squares_system.h"
#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

constexpr int kNumRobustSamples = 200;

// y = 2 c0 - c1 with a little noise on three candidates; a few samples are far
// off.
RegressionProblem WithOutliers() {
  testing::Gaussian random(3);
  const Matrix theta = random.Draw(kNumRobustSamples, 3);
  Vector y = 2.0 * theta.col(0) - theta.col(1) +
             1e-3 * Vector(random.Draw(kNumRobustSamples, 1));
  for (int i = 0; i < 5; ++i) y[i] += 10.0 * theta(i, 0);
  return testing::Problem(theta, y);
}

SelectionEntry LeastSquaresEntry(const RegressionProblem& problem,
                                 const CoefficientMap& map,
                                 const std::vector<int>& support) {
  SelectionEntry entry;
  entry.support = support;
  entry.coefficients = map.Expand(
      FitSupport(Condense(problem, map), map, map.ReduceSupport(support)));
  return entry;
}

TEST(FitRobustly, FewBadSamplesDoNotMoveIt) {
  const RegressionProblem problem = WithOutliers();
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  const SelectionEntry entry = LeastSquaresEntry(problem, map, {0, 1});
  EXPECT_GT(std::abs(entry.coefficients[0] - 2.0), 0.05);
  const Vector robust = FitRobustly(problem, map, entry);
  EXPECT_NEAR(robust[0], 2.0, 1e-3);
  EXPECT_NEAR(robust[1], -1.0, 1e-3);
  EXPECT_EQ(robust[2], 0.0);  // not in the support
}

TEST(FitRobustly, ConditionsHold) {
  RegressionProblem problem = WithOutliers();
  problem.constraints = {CoefficientConstraint::Given("c1", -0.9)};
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  const Vector robust =
      FitRobustly(problem, map, LeastSquaresEntry(problem, map, {0}));
  EXPECT_EQ(robust[1], -0.9);
  EXPECT_NEAR(robust[0], 2.0, 0.05);
}

TEST(FitRobustly, NothingToFit) {
  const RegressionProblem problem = WithOutliers();
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  SelectionEntry entry;
  entry.coefficients = Vector::Zero(3);
  EXPECT_EQ(FitRobustly(problem, map, entry), Vector(Vector::Zero(3)));
}

}  // namespace
}  // namespace pinode
