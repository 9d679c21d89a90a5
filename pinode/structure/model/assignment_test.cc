#include "pinode/structure/model/assignment.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

double Total(const Matrix& profit, const std::vector<int>& column_of_row) {
  double total = 0.0;
  for (int i = 0; i < profit.rows(); ++i) {
    if (column_of_row[i] >= 0) total += profit(i, column_of_row[i]);
  }
  return total;
}

// Returns the best total by trying all assignments: rows <= columns.
double BestTotal(const Matrix& profit) {
  std::vector<int> columns(profit.cols());
  std::iota(columns.begin(), columns.end(), 0);
  double best = -std::numeric_limits<double>::infinity();
  do {
    best = std::max(best, Total(profit, columns));
  } while (std::next_permutation(columns.begin(), columns.end()));
  return best;
}

TEST(MaximumProfitAssignment, IsNotGreedy) {
  // A greedy choice takes 0.9 and then 0.0; the best is 0.8 + 0.8.
  Matrix profit(2, 2);
  profit << 0.9, 0.8, 0.8, 0.0;
  EXPECT_THAT(MaximumProfitAssignment(profit), ElementsAre(1, 0));
}

TEST(MaximumProfitAssignment, AgreesWithTryingAllPermutations) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int rows = 1; rows <= 6; ++rows) {
    for (int columns = rows; columns <= 6; ++columns) {
      for (int trial = 0; trial < 10; ++trial) {
        const Matrix profit =
            Matrix::NullaryExpr(rows, columns, [&] { return uniform(random); });
        const double best = BestTotal(profit);
        const std::vector<int> wide = MaximumProfitAssignment(profit);
        EXPECT_NEAR(Total(profit, wide), best, 1e-12);
        // One to one: no column twice.
        std::vector<int> sorted = wide;
        std::sort(sorted.begin(), sorted.end());
        EXPECT_EQ(std::unique(sorted.begin(), sorted.end()), sorted.end());
        EXPECT_GE(sorted.front(), 0);

        const Matrix tall_profit = profit.transpose();
        const std::vector<int> tall = MaximumProfitAssignment(tall_profit);
        EXPECT_NEAR(Total(tall_profit, tall), best, 1e-12);
        EXPECT_EQ(std::count(tall.begin(), tall.end(), -1), columns - rows);
      }
    }
  }
}

TEST(MaximumProfitAssignment, TakesTiesAndEmptyProblems) {
  const std::vector<int> tied = MaximumProfitAssignment(Matrix::Ones(3, 3));
  EXPECT_THAT(tied, ::testing::UnorderedElementsAre(0, 1, 2));
  EXPECT_THAT(MaximumProfitAssignment(Matrix(0, 0)), IsEmpty());
  EXPECT_THAT(MaximumProfitAssignment(Matrix(0, 2)), IsEmpty());
  EXPECT_THAT(MaximumProfitAssignment(Matrix(2, 0)), ElementsAre(-1, -1));
}

TEST(MaximumProfitAssignmentDeathTest, RefusesNaN) {
  EXPECT_DEATH(MaximumProfitAssignment(Matrix::Constant(
                   1, 1, std::numeric_limits<double>::quiet_NaN())),
               "finite");
}

}  // namespace
}  // namespace pinode
