#include "pinode/estimate/certainty/null_space.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

TEST(DescribeNullSpace, NamesTheLargestPartsFirst) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(3, 10.0, 0.1);
  const ParameterLayout layout(problem);
  Matrix directions(3, 3);
  directions.col(0) << 0.0, 1.0, 0.0;
  directions.col(1) << std::sqrt(0.5), 0.05, -std::sqrt(0.5);
  directions.col(2) << -0.4, 0.0, 0.8;
  const auto sentences = DescribeNullSpace(layout, directions);
  ASSERT_EQ(sentences.size(), 3u);
  EXPECT_EQ(sentences[0], "k2");
  EXPECT_EQ(sentences[1], "k1 - k3");
  EXPECT_EQ(sentences[2], "k3 - 0.5 k1");
  EXPECT_TRUE(DescribeNullSpace(layout, Matrix(3, 0)).empty());
}

TEST(WithUnseenGroups, AddsWhatRoundingAloneHolds) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(3, 10.0, 0.1);
  const ParameterLayout layout(problem);
  const int n = layout.num_free();
  Vector free = Vector::Zero(n);
  Matrix covariance = 1e-4 * Matrix::Identity(n, n);
  EXPECT_EQ(
      WithUnseenGroups(problem, layout, free, covariance, Matrix(n, 0)).cols(),
      0);
  covariance(0, 0) = 1e6;
  const Matrix directions =
      WithUnseenGroups(problem, layout, free, covariance, Matrix(n, 0));
  ASSERT_EQ(directions.cols(), 1);
  EXPECT_EQ(directions.col(0), Vector(Vector::Unit(n, 0)));
  // It is not named twice.
  EXPECT_EQ(
      WithUnseenGroups(problem, layout, free, covariance, directions).cols(),
      1);
  // A group that was negligible beside the identified value is determined.
  free[0] = 1e4;
  EXPECT_EQ(
      WithUnseenGroups(problem, layout, free, covariance, Matrix(n, 0)).cols(),
      0);
}

// Directions of network weights alone have no name.
TEST(DescribeNullSpace, LeavesNetworkWeightsOut) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  const int n = fit.layout->num_free();
  for (int j = 0; j < n; ++j) {
    const int index = fit.layout->free()[static_cast<size_t>(j)];
    const auto sentences =
        DescribeNullSpace(*fit.layout, Matrix(Vector::Unit(n, j)));
    EXPECT_EQ(sentences.size(), fit.layout->IsNamed(index) ? 1u : 0u);
  }
}

}  // namespace
}  // namespace pinode
