#include "pinode/watch/assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace pinode {
namespace {

double CostOf(const Matrix& costs, const std::vector<int>& columns) {
  double sum = 0.0;
  for (size_t i = 0; i < columns.size(); ++i) {
    sum += costs(static_cast<Eigen::Index>(i), columns[i]);
  }
  return sum;
}

// All ways to choose columns, one after the other.
double LeastCost(const Matrix& costs) {
  std::vector<int> order(static_cast<size_t>(costs.cols()));
  std::iota(order.begin(), order.end(), 0);
  double least = 1e300;
  do {
    const std::vector<int> columns(order.begin(), order.begin() + costs.rows());
    least = std::min(least, CostOf(costs, columns));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

TEST(Assignment, IsTheBestOfAll) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::Index rows = 1 + trial % 4;
    const Eigen::Index columns = rows + trial % 3;
    Matrix costs(rows, columns);
    for (double& cost : costs.reshaped()) cost = uniform(random);
    std::vector<int> found = AssignRows(costs);
    EXPECT_NEAR(CostOf(costs, found), LeastCost(costs), 1e-12);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
  }
}

TEST(Assignment, IsNotGreedy) {
  Matrix costs(2, 2);
  costs << 0.0, 0.1, 0.1, 1.0;
  EXPECT_EQ(AssignRows(costs), (std::vector<int>{1, 0}));
}

TEST(Assignment, OfNothing) { EXPECT_TRUE(AssignRows(Matrix(0, 3)).empty()); }

}  // namespace
}  // namespace pinode
