#include "pinode/discover/least_squares_system.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <limits>

#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

// Two outputs with a coupling, a given coefficient and two noise levels.
RegressionProblem Coupled(testing::Gaussian* random) {
  RegressionProblem problem =
      testing::Problem(random->Draw(40, 4), random->Draw(40, 1));
  RegressionOutput second;
  second.name = "z";
  second.candidates = {"c0", "c1", "c2"};
  second.theta = random->Draw(40, 3);
  second.y = random->Draw(40, 1);
  second.sigma = 0.2;
  problem.outputs.push_back(second);
  problem.constraints = {
      CoefficientConstraint::Equal({"y: c1", "z: c2"}, {1.0, -0.5}),
      CoefficientConstraint::Given("z: c0", 0.7)};
  return problem;
}

double SumOfSquares(const RegressionProblem& problem, const Vector& xi,
                    const TimeBlock& block) {
  double sum = 0.0;
  Eigen::Index first = 0;
  for (const RegressionOutput& output : problem.outputs) {
    const Eigen::Index count = output.theta.cols();
    const Vector residual = output.y - output.theta * xi.segment(first, count);
    sum += residual.segment(block.begin, block.count).squaredNorm() /
           (output.sigma * output.sigma);
    first += count;
  }
  return sum;
}

TEST(LeastSquaresSystem, KeepsEverySumOfSquares) {
  testing::Gaussian random(1);
  const RegressionProblem problem = Coupled(&random);
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  ASSERT_EQ(map.num_free(), 5);
  // The last block has fewer samples than unknowns.
  for (const TimeBlock& block : {TimeBlock{0, 40}, {5, 20}, {37, 3}}) {
    const LeastSquaresSystem system = Condense(problem, map, block);
    EXPECT_LE(system.A.rows(), 5);
    EXPECT_EQ(system.num_residuals, 2 * block.count);
    for (int trial = 0; trial < 5; ++trial) {
      const Vector g = random.Draw(5, 1);
      const double expected = SumOfSquares(problem, map.Expand(g), block);
      EXPECT_NEAR(system.SumOfSquares(g), expected, 1e-12 * expected);
    }
  }
}

TEST(LeastSquaresSystem, CombinesBlocksAsOftenAsTheyCount) {
  testing::Gaussian random(2);
  const RegressionProblem problem = Coupled(&random);
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  const std::vector<TimeBlock> blocks = DivideIntoBlocks(problem, 8);
  std::vector<LeastSquaresSystem> systems;
  for (const TimeBlock& block : blocks) {
    systems.push_back(Condense(problem, map, block));
  }
  const std::vector<int> multiplicities = {2, 0, 1, 1, 0, 3, 1, 0};
  const LeastSquaresSystem combined = Combine(systems, multiplicities);
  EXPECT_EQ(combined.num_residuals, 80);
  const Vector g = random.Draw(5, 1);
  double expected = 0.0;
  for (size_t k = 0; k < blocks.size(); ++k) {
    expected +=
        multiplicities[k] * SumOfSquares(problem, map.Expand(g), blocks[k]);
  }
  EXPECT_NEAR(combined.SumOfSquares(g), expected, 1e-12 * expected);
}

TEST(FitSupport, IsLeastSquaresOnTheSupport) {
  testing::Gaussian random(3);
  const Matrix theta = random.Draw(30, 6);
  const Vector y = random.Draw(30, 1);
  const RegressionProblem problem = testing::Problem(theta, y);
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  const LeastSquaresSystem system = Condense(problem, map);
  Matrix columns(30, 2);
  columns << theta.col(1), theta.col(4);
  Vector expected = columns.colPivHouseholderQr().solve(y);
  Vector fit = FitSupport(system, map, {1, 4});
  EXPECT_NEAR(fit[1], expected[0], 1e-14);
  EXPECT_NEAR(fit[4], expected[1], 1e-14);
  EXPECT_EQ(fit.cwiseAbs().sum(), std::abs(fit[1]) + std::abs(fit[4]));
  EXPECT_EQ(FitSupport(system, map, {}), Vector::Zero(6));

  // Normal equations of the ridge.
  const Matrix gram = columns.transpose() * columns;
  Matrix ridged = gram;
  ridged.diagonal() += 0.3 * gram.diagonal();
  expected = ridged.colPivHouseholderQr().solve(columns.transpose() * y);
  fit = FitSupport(system, map, {1, 4}, 0.3);
  EXPECT_NEAR(fit[1], expected[0], 1e-14);
  EXPECT_NEAR(fit[4], expected[1], 1e-14);
}

// All subsets of the columns, each with its unconstrained solution: the best
// that has the right signs.
TEST(FitSupport, KeepsSignsAtTheLeastSumOfSquares) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    testing::Gaussian random(seed);
    const Matrix theta = random.Draw(12, 5);
    RegressionProblem problem = testing::Problem(theta, random.Draw(12, 1));
    problem.constraints = {CoefficientConstraint::Positive("c0"),
                           CoefficientConstraint::Negative("c2"),
                           CoefficientConstraint::Positive("c3")};
    CoefficientMap map;
    std::string error;
    ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
    const LeastSquaresSystem system = Condense(problem, map);
    double least = std::numeric_limits<double>::infinity();
    for (int subset = 0; subset < 32; ++subset) {
      std::vector<int> columns;
      for (int j = 0; j < 5; ++j) {
        if ((subset >> j & 1) != 0) columns.push_back(j);
      }
      Vector g = Vector::Zero(5);
      if (!columns.empty()) {
        const Matrix chosen = theta(Eigen::all, columns);
        g(columns) =
            Vector(chosen.colPivHouseholderQr().solve(problem.outputs[0].y));
      }
      if (g[0] >= 0.0 && g[2] <= 0.0 && g[3] >= 0.0) {
        least = std::min(least, system.SumOfSquares(g));
      }
    }
    const Vector fit = FitSupport(system, map, {0, 1, 2, 3, 4});
    EXPECT_GE(fit[0], 0.0);
    EXPECT_LE(fit[2], 0.0);
    EXPECT_GE(fit[3], 0.0);
    EXPECT_NEAR(system.SumOfSquares(fit), least, 1e-12 * least) << seed;
  }
}

}  // namespace
}  // namespace pinode
