#include "pinode/discover/stlsq.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

StlsqSolution Solved(const RegressionProblem& problem,
                     const StlsqOptions& options) {
  StlsqSolution solution;
  std::string error;
  EXPECT_TRUE(SolveStlsq(problem, options, &solution, &error)) << error;
  return solution;
}

// On orthonormal columns dropping one changes no other: one pass.
TEST(Stlsq, ThresholdsOrthonormalColumnsOnce) {
  testing::Gaussian random(1);
  const Matrix theta =
      Eigen::HouseholderQR<Matrix>(random.Draw(20, 4)).householderQ() *
      Matrix::Identity(20, 4);
  Vector xi(4);
  xi << 3.0, -2.0, 0.5, 0.1;
  const RegressionProblem problem = testing::Problem(theta, theta * xi);
  StlsqOptions options;
  options.scaled = false;
  options.threshold = 0.4;
  const StlsqSolution solution = Solved(problem, options);
  EXPECT_THAT(solution.support, ElementsAre(0, 1, 2));
  EXPECT_TRUE(solution.converged);
  EXPECT_EQ(solution.num_iterations, 2);
  EXPECT_NEAR(solution.coefficients[2], 0.5, 1e-14);
  EXPECT_EQ(solution.coefficients[3], 0.0);
  EXPECT_NEAR(solution.sum_of_squares, 0.01, 1e-14);
  // |y| = sqrt(13.26): 0.5 is a share of 0.137.
  options.scaled = true;
  options.threshold = 0.135;
  EXPECT_THAT(Solved(problem, options).support, ElementsAre(0, 1, 2));
  options.threshold = 0.14;
  EXPECT_THAT(Solved(problem, options).support, ElementsAre(0, 1));
}

// y = e0 - 0.06 e1 + 0.05 e2 on e0, e1 and (e0 + e1 + e2) / sqrt(3): first the
// third leaves, at 0.087; that moves the second from -0.11 to -0.06.
TEST(Stlsq, GoesOnUntilNoneIsDropped) {
  Matrix theta = Matrix::Identity(4, 3);
  theta.col(2) = Vector::Ones(4) / std::sqrt(3.0);
  theta(3, 2) = 0.0;
  const Vector y = (Vector(4) << 1.0, -0.06, 0.05, 0.0).finished();
  StlsqOptions options;
  options.scaled = false;
  options.threshold = 0.1;
  const StlsqSolution solution = Solved(testing::Problem(theta, y), options);
  EXPECT_TRUE(solution.converged);
  EXPECT_EQ(solution.num_iterations, 3);
  EXPECT_THAT(solution.support, ElementsAre(0));
  EXPECT_NEAR(solution.coefficients[0], 1.0, 1e-15);
  options.max_num_iterations = 1;
  const StlsqSolution early = Solved(testing::Problem(theta, y), options);
  EXPECT_FALSE(early.converged);
  EXPECT_THAT(early.support, ElementsAre(0, 1));
}

TEST(Stlsq, FindsTheTrueTerms) {
  const RegressionProblem problem = testing::Duffing(400, 0.01, 3);
  StlsqOptions options;
  options.threshold = 0.02;
  const StlsqSolution solution = Solved(problem, options);
  EXPECT_EQ(solution.support, testing::DuffingSupport());
  EXPECT_NEAR(solution.coefficients[0], -4.0, 0.05);
  EXPECT_NEAR(solution.coefficients[1], -0.3, 0.01);
  EXPECT_NEAR(solution.coefficients[5], -6.0, 0.1);
  // The same by hand: least squares on the three columns.
  const Matrix columns =
      problem.outputs[0].theta(Eigen::all, testing::DuffingSupport());
  const Vector expected =
      columns.colPivHouseholderQr().solve(problem.outputs[0].y);
  EXPECT_NEAR(solution.coefficients[5], expected[2], 1e-11);
}

TEST(Stlsq, ScaledThresholdsDoNotKnowUnits) {
  const RegressionProblem problem = testing::Duffing(300, 0.01, 4);
  RegressionProblem other = problem;
  other.outputs[0].theta.col(5) *= 1e-9;
  other.outputs[0].theta.col(7) *= 1e6;
  StlsqOptions options;
  options.threshold = 0.02;
  EXPECT_EQ(Solved(other, options).support, testing::DuffingSupport());
  EXPECT_NEAR(Solved(other, options).coefficients[5], -6e9, 1e8);
  // As it stands the method keeps what has a small unit.
  options.scaled = false;
  options.threshold = 1e3;
  EXPECT_THAT(Solved(other, options).support, ElementsAre(5));
}

TEST(Stlsq, RidgeIsForThresholdingOnly) {
  testing::Gaussian random(5);
  const Matrix theta = random.Draw(50, 3);
  const Vector y = theta.col(0) + 0.1 * random.Draw(50, 1);
  StlsqOptions options;
  options.threshold = 0.4;
  options.ridge = 1.0;
  // The ridge halves the coefficient, which stays above the threshold.
  const StlsqSolution solution = Solved(testing::Problem(theta, y), options);
  ASSERT_THAT(solution.support, ElementsAre(0));
  EXPECT_NEAR(solution.coefficients[0],
              theta.col(0).dot(y) / theta.col(0).squaredNorm(), 1e-14);
  options.threshold = 0.6;
  EXPECT_THAT(Solved(testing::Problem(theta, y), options).support, IsEmpty());
}

TEST(Stlsq, ConstraintsHold) {
  RegressionProblem problem = testing::Duffing(300, 0.01, 6);
  problem.constraints = {CoefficientConstraint::Given("v", -0.5),
                         CoefficientConstraint::Positive("x^3")};
  StlsqOptions options;
  options.threshold = 0.02;
  const StlsqSolution solution = Solved(problem, options);
  EXPECT_EQ(solution.coefficients[1], -0.5);
  EXPECT_THAT(solution.support, ::testing::Not(::testing::Contains(1)));
  EXPECT_GE(solution.coefficients[5], 0.0);
  problem.constraints = {CoefficientConstraint::Equal({"x", "x^3"}, {2, 3})};
  const StlsqSolution bound = Solved(problem, options);
  EXPECT_EQ(bound.support, testing::DuffingSupport());
  EXPECT_NEAR(bound.coefficients[0] / 2.0, bound.coefficients[5] / 3.0, 1e-14);
  EXPECT_NEAR(bound.coefficients[0], -4.0, 0.05);
}

// As it stands, the largest of the coefficients bound by an equality counts.
TEST(Stlsq, PlainThresholdOfAnEquality) {
  RegressionProblem problem =
      testing::Problem(Matrix::Identity(3, 2), Vector::Zero(3));
  problem.outputs[0].y << 0.01, 0.5, 0.0;
  problem.constraints = {CoefficientConstraint::Equal({"c0", "c1"}, {1, 50})};
  StlsqOptions options;
  options.scaled = false;
  options.threshold = 0.4;
  EXPECT_THAT(Solved(problem, options).support, ElementsAre(0, 1));
  options.threshold = 0.6;
  EXPECT_THAT(Solved(problem, options).support, IsEmpty());
}

TEST(Stlsq, PathOverThresholds) {
  const RegressionProblem problem = testing::Duffing(300, 0.01, 7);
  std::vector<StlsqSolution> path;
  std::string error;
  ASSERT_TRUE(SolveStlsqPath(problem, {}, {}, &path, &error)) << error;
  ASSERT_EQ(path.size(), 40u);
  EXPECT_EQ(path.front().threshold, 1.0);
  EXPECT_NEAR(path.back().threshold, 1e-4, 1e-16);
  EXPECT_LE(path.front().support.size(), 1u);
  EXPECT_GT(path.back().support.size(), 10u);
  EXPECT_LT(path.back().sum_of_squares, path.front().sum_of_squares);
}

TEST(Stlsq, ZeroColumnsAndNothingToExplain) {
  RegressionProblem problem =
      testing::Problem(Matrix::Zero(5, 2), Vector::Zero(5));
  problem.outputs[0].theta.col(0).setOnes();
  StlsqOptions options;
  options.threshold = 0.0;
  EXPECT_THAT(Solved(problem, options).support, IsEmpty());
  problem.outputs[0].y.setConstant(2.0);
  EXPECT_THAT(Solved(problem, options).support, ElementsAre(0));
}

TEST(Stlsq, RefusesBadOptions) {
  const RegressionProblem problem =
      testing::Problem(Matrix::Ones(5, 1), Vector::Ones(5));
  StlsqSolution solution;
  std::string error;
  StlsqOptions options;
  options.threshold = -1.0;
  EXPECT_FALSE(SolveStlsq(problem, options, &solution, &error));
  EXPECT_THAT(error, HasSubstr("threshold -1"));
  options = {};
  options.ridge = NAN;
  EXPECT_FALSE(SolveStlsq(problem, options, &solution, &error));
  EXPECT_THAT(error, HasSubstr("ridge nan"));
  options = {};
  options.max_num_iterations = 0;
  EXPECT_FALSE(SolveStlsq(problem, options, &solution, &error));
  EXPECT_THAT(error, HasSubstr("max_num_iterations 0"));
}

}  // namespace
}  // namespace pinode
