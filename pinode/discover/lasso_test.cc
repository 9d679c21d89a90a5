#include "pinode/discover/lasso.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

LassoPath Solved(const RegressionProblem& problem,
                 const LassoOptions& options) {
  LassoPath path;
  std::string error;
  EXPECT_TRUE(SolveLassoPath(problem, options, &path, &error)) << error;
  return path;
}

RegressionProblem Random(uint64_t seed, int samples, int columns) {
  testing::Gaussian random(seed);
  Matrix theta = random.Draw(samples, columns);
  for (int j = 1; j < columns; ++j) theta.col(j) += 0.5 * theta.col(j - 1);
  Vector y = 0.3 * random.Draw(samples, 1);
  y += theta.col(0) - 2.0 * theta.col(3) + 0.5 * theta.col(5);
  return testing::Problem(theta, y);
}

// With orthonormal columns the solution is known: soft thresholding.
TEST(Lasso, SoftThresholdsOrthonormalColumns) {
  testing::Gaussian random(1);
  const Matrix theta =
      Eigen::HouseholderQR<Matrix>(random.Draw(20, 5)).householderQ() *
      Matrix::Identity(20, 5);
  Vector xi(5);
  xi << 3.0, -2.0, 1.0, 0.5, 0.0;
  const RegressionProblem problem = testing::Problem(theta, theta * xi);
  LassoOptions options;
  options.lambdas = {2.5, 1.5, 0.75, 0.1};
  for (bool polish : {true, false}) {
    options.polish = polish;
    options.function_tolerance = 1e-15;
    const LassoPath path = Solved(problem, options);
    EXPECT_NEAR(path.lambda_max, 3.0, 1e-14);
    ASSERT_EQ(path.solutions.size(), 4u);
    for (const LassoSolution& solution : path.solutions) {
      EXPECT_TRUE(solution.converged);
      for (int j = 0; j < 5; ++j) {
        const double expected = std::copysign(
            std::max(0.0, std::abs(xi[j]) - solution.lambda), xi[j]);
        EXPECT_NEAR(solution.coefficients[j], expected, polish ? 1e-14 : 1e-6)
            << "lambda " << solution.lambda;
      }
    }
    EXPECT_THAT(path.solutions[0].support, ElementsAre(0));
    EXPECT_THAT(path.solutions[1].support, ElementsAre(0, 1));
    EXPECT_THAT(path.solutions[3].support, ElementsAre(0, 1, 2, 3));
  }
}

TEST(Lasso, MeetsTheOptimalityConditionsAlongThePath) {
  const RegressionProblem problem = Random(2, 50, 30);
  const Matrix& theta = problem.outputs[0].theta;
  const Vector weights = theta.colwise().norm().transpose();
  const LassoPath path = Solved(problem, LassoOptions());
  ASSERT_EQ(path.solutions.size(), 50u);
  EXPECT_EQ(path.solutions.front().lambda, path.lambda_max);
  EXPECT_THAT(path.solutions.front().support, IsEmpty());
  EXPECT_NEAR(path.solutions.back().lambda, 1e-4 * path.lambda_max,
              1e-12 * path.lambda_max);
  for (const LassoSolution& solution : path.solutions) {
    EXPECT_TRUE(solution.converged);
    const Vector residual =
        problem.outputs[0].y - theta * solution.coefficients;
    const Vector pull = theta.transpose() * residual;
    std::vector<int> nonzero;
    for (int j = 0; j < 30; ++j) {
      const double xi = solution.coefficients[j];
      const double limit = solution.lambda * weights[j];
      if (xi == 0.0) {
        EXPECT_LE(std::abs(pull[j]), limit * (1.0 + 1e-9));
      } else {
        EXPECT_NEAR(pull[j], std::copysign(limit, xi), 1e-9 * limit);
        nonzero.push_back(j);
      }
    }
    EXPECT_EQ(solution.support, nonzero);
    const double objective =
        0.5 * residual.squaredNorm() +
        solution.lambda * weights.dot(solution.coefficients.cwiseAbs());
    EXPECT_NEAR(solution.objective, objective, 1e-12 * objective);
    EXPECT_LT(solution.duality_gap, 1e-10 * objective);
  }
  // Just below lambda_max something is in the model.
  LassoOptions options;
  options.lambdas = {path.lambda_max * (1.0 - 1e-6)};
  EXPECT_EQ(Solved(problem, options).solutions[0].support.size(), 1u);
}

TEST(Lasso, APathEndsWhereOneOfItsPointsDoes) {
  const RegressionProblem problem = Random(3, 50, 30);
  const LassoPath path = Solved(problem, LassoOptions());
  for (size_t i : {10, 25, 49}) {
    LassoOptions options;
    options.lambdas = {path.solutions[i].lambda};
    const LassoSolution alone = Solved(problem, options).solutions[0];
    EXPECT_EQ(alone.support, path.solutions[i].support);
    EXPECT_LT((alone.coefficients - path.solutions[i].coefficients).norm(),
              1e-12 * alone.coefficients.norm());
  }
}

// The gap is an upper bound of what a crude solution lacks.
TEST(Lasso, DualityGapBoundsTheError) {
  const RegressionProblem problem = Random(4, 40, 20);
  LassoOptions crude;
  crude.polish = false;
  crude.num_lambdas = 6;
  crude.max_num_iterations = 3;
  const LassoPath rough = Solved(problem, crude);
  const LassoPath exact = Solved(problem, [&] {
    LassoOptions options;
    options.num_lambdas = 6;
    return options;
  }());
  int unfinished = 0;
  for (size_t i = 0; i < rough.solutions.size(); ++i) {
    const LassoSolution& solution = rough.solutions[i];
    const double excess = solution.objective - exact.solutions[i].objective;
    EXPECT_GE(excess, -1e-12 * solution.objective);
    EXPECT_LE(excess, solution.duality_gap + 1e-12 * solution.objective);
    if (!solution.converged) ++unfinished;
  }
  EXPECT_GT(unfinished, 0);
}

// A change of units changes the coefficients' units and nothing else.
TEST(Lasso, UnitsDoNotMatter) {
  const RegressionProblem problem = Random(5, 60, 12);
  RegressionProblem other = problem;
  Vector units(12);
  for (int j = 0; j < 12; ++j) units[j] = std::pow(10.0, j - 6);
  other.outputs[0].theta = problem.outputs[0].theta * units.asDiagonal();
  other.outputs[0].y *= 1e3;
  const LassoPath path = Solved(problem, LassoOptions());
  const LassoPath changed = Solved(other, LassoOptions());
  ASSERT_EQ(path.solutions.size(), changed.solutions.size());
  for (size_t i = 0; i < path.solutions.size(); ++i) {
    EXPECT_EQ(path.solutions[i].support, changed.solutions[i].support);
    const Vector back =
        changed.solutions[i].coefficients.cwiseProduct(units) / 1e3;
    EXPECT_LT((back - path.solutions[i].coefficients).norm(),
              1e-12 * (1.0 + back.norm()));
  }
}

TEST(Lasso, AGivenCoefficientIsSubtracted) {
  RegressionProblem problem = Random(6, 40, 8);
  RegressionProblem shifted = problem;
  shifted.outputs[0].y -= 1.7 * problem.outputs[0].theta.col(3);
  shifted.outputs[0].theta.col(3).setZero();
  problem.constraints = {CoefficientConstraint::Given("c3", 1.7)};
  const LassoPath given = Solved(problem, LassoOptions());
  const LassoPath without = Solved(shifted, LassoOptions());
  ASSERT_EQ(given.solutions.size(), without.solutions.size());
  for (size_t i = 0; i < given.solutions.size(); ++i) {
    EXPECT_EQ(given.solutions[i].coefficients[3], 1.7);
    EXPECT_EQ(without.solutions[i].coefficients[3], 0.0);
    Vector rest = given.solutions[i].coefficients;
    rest[3] = 0.0;
    EXPECT_LT((rest - without.solutions[i].coefficients).norm(), 1e-12);
    EXPECT_EQ(given.solutions[i].support, without.solutions[i].support);
    EXPECT_NEAR(given.solutions[i].objective, without.solutions[i].objective,
                1e-12 * given.solutions[i].objective);
  }
}

TEST(Lasso, SignsHold) {
  RegressionProblem problem = Random(7, 40, 8);
  LassoOptions options;
  options.penalty_weights = Vector::Ones(8);
  const LassoPath free = Solved(problem, options);
  ASSERT_LT(free.solutions.back().coefficients[3], -1.0);
  problem.constraints = {CoefficientConstraint::Positive("c3"),
                         CoefficientConstraint::Positive("c0"),
                         CoefficientConstraint::Negative("c6")};
  options.lambdas = {3.0, 1.0, 0.1};
  for (bool polish : {true, false}) {
    options.polish = polish;
    options.function_tolerance = polish ? 1e-10 : 1e-16;
    options.max_num_iterations = 5000;
    for (const LassoSolution& solution : Solved(problem, options).solutions) {
      EXPECT_TRUE(solution.converged);
      EXPECT_EQ(solution.coefficients[3], 0.0);
      EXPECT_GT(solution.coefficients[0], 0.0);
      EXPECT_LE(solution.coefficients[6], 0.0);
      const Vector pull = problem.outputs[0].theta.transpose() *
                          (problem.outputs[0].y -
                           problem.outputs[0].theta * solution.coefficients);
      const double limit = solution.lambda * (1.0 + 1e-5);
      for (int j = 0; j < 8; ++j) {
        // Only the permitted side pulls.
        if (j != 3 && j != 0) {
          EXPECT_GE(pull[j], -limit);
        }
        if (j != 6) {
          EXPECT_LE(pull[j], limit);
        }
      }
      EXPECT_LT(solution.duality_gap, 1e-5 * solution.objective);
    }
  }
}

// Two coefficients bound by factors are one, on the sum of their columns.
TEST(Lasso, AnEqualityMergesColumns) {
  RegressionProblem problem = Random(8, 40, 6);
  const Matrix theta = problem.outputs[0].theta;
  RegressionProblem merged = problem;
  merged.outputs[0].theta = theta.leftCols(5);
  merged.outputs[0].theta.col(1) = 2.0 * theta.col(1) - 0.5 * theta.col(5);
  merged.outputs[0].candidates.pop_back();
  problem.constraints = {
      CoefficientConstraint::Equal({"c1", "c5"}, {2.0, -0.5})};
  LassoOptions plain;
  plain.penalty_weights = Vector::Ones(6);
  LassoOptions weighted;
  weighted.penalty_weights = Vector::Ones(5);
  weighted.penalty_weights[1] = 2.5;
  for (const auto& [bound, single] :
       {std::make_pair(LassoOptions(), LassoOptions()),
        std::make_pair(plain, weighted)}) {
    const LassoPath path = Solved(problem, bound);
    const LassoPath expected = Solved(merged, single);
    EXPECT_NEAR(path.lambda_max, expected.lambda_max, 1e-12);
    for (size_t i = 0; i < path.solutions.size(); ++i) {
      const Vector& xi = path.solutions[i].coefficients;
      const Vector& g = expected.solutions[i].coefficients;
      EXPECT_NEAR(xi[1], 2.0 * g[1], 1e-12);
      EXPECT_EQ(xi[5], -0.25 * xi[1]);
      EXPECT_NEAR(xi[2], g[2], 1e-12);
      EXPECT_NEAR(path.solutions[i].objective, expected.solutions[i].objective,
                  1e-12 * expected.solutions[i].objective);
    }
  }
}

// A coupling between outputs: the accelerations of two unequal masses joined by
// a spring; symmetric forces, so the accelerations' coefficients are as 1/m.
TEST(Lasso, SymmetricCouplingOfTwoOutputs) {
  testing::Gaussian random(9);
  const double m1 = 2.0;
  const double m2 = 0.5;
  const double k = 30.0;
  const Matrix x = random.Draw(80, 2);
  RegressionProblem problem =
      testing::Problem(x, -40.0 / m1 * x.col(0) + k / m1 * x.col(1));
  problem.outputs.push_back(problem.outputs[0]);
  problem.outputs[0].name = "a[1]";
  problem.outputs[1].name = "a[2]";
  problem.outputs[1].y = k / m2 * x.col(0) - 50.0 / m2 * x.col(1);
  for (RegressionOutput& output : problem.outputs) {
    output.y += 2.0 * random.Draw(80, 1);
  }
  problem.constraints = {
      CoefficientConstraint::Equal({"a[1]: c1", "a[2]: c0"}, {1 / m1, 1 / m2})};
  const LassoSolution last = Solved(problem, LassoOptions()).solutions.back();
  EXPECT_TRUE(last.converged);
  EXPECT_NEAR(m1 * last.coefficients[1], m2 * last.coefficients[2], 1e-12);
  EXPECT_NEAR(m1 * last.coefficients[1], k, 1.0);
  EXPECT_THAT(last.support, ElementsAre(0, 1, 2, 3));
}

TEST(Lasso, DoubleAndEmptyColumns) {
  RegressionProblem problem = Random(10, 40, 8);
  problem.outputs[0].theta.col(6).setZero();
  problem.outputs[0].theta.col(7) = -problem.outputs[0].theta.col(3);
  const LassoPath path = Solved(problem, LassoOptions());
  for (const LassoSolution& solution : path.solutions) {
    EXPECT_TRUE(solution.converged);
    EXPECT_LT(solution.duality_gap, 1e-10 * solution.objective);
    EXPECT_EQ(solution.coefficients[6], 0.0);
    EXPECT_EQ(solution.coefficients[3] * solution.coefficients[7], 0.0);
  }
  EXPECT_NEAR(path.solutions.back().coefficients[3] -
                  path.solutions.back().coefficients[7],
              -2.0, 0.3);
}

TEST(Lasso, NothingToExplain) {
  RegressionProblem problem = Random(11, 20, 6);
  problem.outputs[0].y.setZero();
  LassoPath path = Solved(problem, LassoOptions());
  ASSERT_EQ(path.solutions.size(), 1u);
  EXPECT_EQ(path.lambda_max, 0.0);
  EXPECT_EQ(path.solutions[0].objective, 0.0);
  EXPECT_THAT(path.solutions[0].support, IsEmpty());
  problem = Random(11, 20, 6);
  for (int j = 0; j < 6; ++j) {
    problem.constraints.push_back(
        CoefficientConstraint::Given("c" + std::to_string(j), 1.0));
  }
  path = Solved(problem, LassoOptions());
  ASSERT_EQ(path.solutions.size(), 1u);
  EXPECT_EQ(path.solutions[0].coefficients, Vector::Ones(6));
  EXPECT_NEAR(
      path.solutions[0].objective,
      0.5 * (problem.outputs[0].y - problem.outputs[0].theta * Vector::Ones(6))
                .squaredNorm(),
      1e-12);
}

TEST(Lasso, StopsAtTheLargestSupport) {
  LassoOptions options;
  options.max_support = 4;
  const LassoPath path = Solved(Random(12, 50, 30), options);
  ASSERT_LT(path.solutions.size(), 50u);
  EXPECT_GT(path.solutions.back().support.size(), 4u);
  for (size_t i = 0; i + 1 < path.solutions.size(); ++i) {
    EXPECT_LE(path.solutions[i].support.size(), 4u);
  }
}

TEST(Lasso, RefusesBadOptions) {
  const RegressionProblem problem = Random(13, 20, 6);
  const auto refused = [&](const LassoOptions& options) {
    LassoPath path;
    std::string error;
    EXPECT_FALSE(SolveLassoPath(problem, options, &path, &error));
    EXPECT_TRUE(path.solutions.empty());
    return error;
  };
  LassoOptions options;
  options.lambdas = {1.0, 2.0};
  EXPECT_THAT(refused(options), HasSubstr("lambda 2, expected positive"));
  options = {};
  options.num_lambdas = 0;
  EXPECT_THAT(refused(options), HasSubstr("num_lambdas 0"));
  options = {};
  options.smallest_ratio = 1.0;
  EXPECT_THAT(refused(options), HasSubstr("smallest_ratio 1"));
  options = {};
  options.penalty_weights = Vector::Ones(5);
  EXPECT_THAT(refused(options), HasSubstr("5 penalty weights, expected 6"));
  options.penalty_weights = Vector::Zero(6);
  EXPECT_THAT(refused(options), HasSubstr("penalty weights"));
  options = {};
  options.max_num_iterations = 0;
  EXPECT_THAT(refused(options), HasSubstr("max_num_iterations 0"));
  RegressionProblem bad = problem;
  bad.outputs[0].y[0] = NAN;
  LassoPath path;
  std::string error;
  EXPECT_FALSE(SolveLassoPath(bad, LassoOptions(), &path, &error));
  EXPECT_THAT(error, HasSubstr("not finite"));
}

}  // namespace
}  // namespace pinode
