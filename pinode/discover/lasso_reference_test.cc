// The LASSO against the solutions by scikit-learn in data/lasso.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/discover/lasso.h"
#include "pinode/record/table.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace {

struct Reference {
  bool scaled = false;
  double lambda = 0.0;
  double objective = 0.0;
  Vector coefficients;
};

Table ReadOrFail(const std::string& name) {
  Table table;
  std::string error;
  EXPECT_TRUE(
      ReadCsvTable(std::string(PINODE_SOURCE_DIR) + "/data/lasso/" + name, {},
                   &table, &error))
      << error;
  return table;
}

class LassoReference : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const Table samples = ReadOrFail(std::string(GetParam()) + ".csv");
    RegressionOutput output;
    output.name = "y";
    output.candidates.assign(samples.columns.begin() + 1,
                             samples.columns.end());
    output.y = samples.values.col(0);
    output.theta = samples.values.rightCols(samples.values.cols() - 1);
    problem_.outputs = {output};
    const Table solutions =
        ReadOrFail(std::string(GetParam()) + "_solutions.csv");
    for (Eigen::Index i = 0; i < solutions.values.rows(); ++i) {
      Reference reference;
      reference.scaled = solutions.values(i, 0) == 1.0;
      reference.lambda = solutions.values(i, 1);
      reference.objective = solutions.values(i, 2);
      reference.coefficients =
          solutions.values.row(i).tail(output.theta.cols()).transpose();
      references_.push_back(reference);
    }
    ASSERT_EQ(references_.size(), 8u);
  }

  Vector Weights(bool scaled) const {
    const Matrix& theta = problem_.outputs[0].theta;
    if (!scaled) return Vector::Ones(theta.cols());
    return theta.colwise().norm().transpose();
  }

  // |Theta_j'(y - Theta xi)| / w_j at lambda: the support by the optimality
  // conditions.
  std::vector<int> Support(const Reference& at, const Vector& coefficients) {
    const Matrix& theta = problem_.outputs[0].theta;
    const Vector residual = problem_.outputs[0].y - theta * coefficients;
    const Vector pull = (theta.transpose() * residual)
                            .cwiseAbs()
                            .cwiseQuotient(Weights(at.scaled));
    std::vector<int> support;
    for (int j = 0; j < static_cast<int>(pull.size()); ++j) {
      EXPECT_LE(pull[j], at.lambda * (1.0 + 1e-6)) << "candidate " << j;
      if (pull[j] >= at.lambda * (1.0 - 1e-6)) support.push_back(j);
    }
    return support;
  }

  // The two paths, of plain and of scaled penalty, in the file's order.
  std::vector<LassoSolution> Solve(const LassoOptions& base) {
    std::vector<LassoSolution> solutions;
    for (bool scaled : {false, true}) {
      LassoOptions options = base;
      for (const Reference& reference : references_) {
        if (reference.scaled == scaled) {
          options.lambdas.push_back(reference.lambda);
        }
      }
      // Norms of the columns are the default.
      if (!scaled) options.penalty_weights = Weights(false);
      LassoPath path;
      std::string error;
      EXPECT_TRUE(SolveLassoPath(problem_, options, &path, &error)) << error;
      solutions.insert(solutions.end(), path.solutions.begin(),
                       path.solutions.end());
    }
    EXPECT_EQ(solutions.size(), references_.size());
    return solutions;
  }

  // Largest difference of coefficients, in units of the largest; each counts
  // with its column's norm, so that no coefficient is too small to count.
  double Difference(const Reference& reference, const Vector& coefficients) {
    const Vector norms = Weights(true);
    const Vector difference =
        norms.cwiseProduct(coefficients - reference.coefficients);
    return difference.cwiseAbs().maxCoeff() /
           norms.cwiseProduct(reference.coefficients).cwiseAbs().maxCoeff();
  }

  RegressionProblem problem_;
  std::vector<Reference> references_;
};

TEST_P(LassoReference, ObjectiveCoefficientsAndSupportAgree) {
  const std::vector<LassoSolution> solutions = Solve(LassoOptions());
  double worst_objective = 0.0;
  double worst_coefficient = 0.0;
  for (size_t i = 0; i < solutions.size(); ++i) {
    const Reference& reference = references_[i];
    const LassoSolution& solution = solutions[i];
    SCOPED_TRACE("lambda " + FormatNumber(reference.lambda));
    EXPECT_TRUE(solution.converged);
    const double objective =
        std::abs(solution.objective / reference.objective - 1.0);
    EXPECT_LT(objective, 1e-9);
    EXPECT_LT(solution.duality_gap, 1e-9 * solution.objective);
    const double coefficient = Difference(reference, solution.coefficients);
    EXPECT_LT(coefficient, 1e-6);
    EXPECT_EQ(solution.support, Support(reference, solution.coefficients));
    EXPECT_EQ(solution.support, Support(reference, reference.coefficients));
    worst_objective = std::max(worst_objective, objective);
    worst_coefficient = std::max(worst_coefficient, coefficient);
  }
  const std::string what =
      std::string("LASSO against scikit-learn, ") + GetParam() + ": ";
  testing::ReportFigure(what + "objective, relative difference",
                        testing::AtMost(1e-9), worst_objective);
  testing::ReportFigure(what + "coefficients, relative difference",
                        testing::AtMost(1e-6), worst_coefficient);
}

// Levenberg-Marquardt on the product form by itself, without the linear system
// of the polish behind it.
TEST_P(LassoReference, LevenbergMarquardtAlone) {
  LassoOptions options;
  options.polish = false;
  options.max_num_iterations = 2000;
  options.function_tolerance = 1e-15;
  const std::vector<LassoSolution> solutions = Solve(options);
  double worst_objective = 0.0;
  double worst_coefficient = 0.0;
  for (size_t i = 0; i < solutions.size(); ++i) {
    const Reference& reference = references_[i];
    SCOPED_TRACE("lambda " + FormatNumber(reference.lambda));
    const double objective =
        std::abs(solutions[i].objective / reference.objective - 1.0);
    EXPECT_LT(objective, 1e-9);
    const double coefficient = Difference(reference, solutions[i].coefficients);
    EXPECT_LT(coefficient, 1e-5);
    EXPECT_EQ(solutions[i].support, Support(reference, reference.coefficients));
    worst_objective = std::max(worst_objective, objective);
    worst_coefficient = std::max(worst_coefficient, coefficient);
  }
  std::cout << GetParam() << ", without the polish: objective within "
            << FormatNumber(worst_objective, 2) << ", coefficients within "
            << FormatNumber(worst_coefficient, 2) << " (relative)\n";
}

INSTANTIATE_TEST_SUITE_P(Problems, LassoReference,
                         ::testing::Values("wide", "ill_scaled", "duffing"));

}  // namespace
}  // namespace pinode
