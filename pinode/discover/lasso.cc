#include "pinode/discover/lasso.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/discover/active_set.h"

namespace pinode {
namespace {

// Tolerance in units in which b and all columns have length 1.
constexpr double kEntryTolerance = 1e-10;
// Accepted violation of the conditions without polish, relative to the penalty.
constexpr double kSubgradientTolerance = 1e-5;
// Largest number of restarts at one lambda; each runs a whole minimisation.
constexpr int kMaxRestarts = 30;

// Cost with residuals [b - A z; sqrt(penalty) p; sqrt(penalty) q] of the
// columns of `A`, with z = p q, or z = sign p^2 where the sign is fixed.
// Parameters: p (and q) of each column in turn.
class ProductCost : public ceres::CostFunction {
 public:
  ProductCost(Matrix A, Vector b, Vector penalty, std::vector<int> signs)
      : A_(std::move(A)),
        b_(std::move(b)),
        penalty_(std::move(penalty)),
        signs_(std::move(signs)) {
    int parameters = 0;
    for (int sign : signs_) parameters += sign == 0 ? 2 : 1;
    mutable_parameter_block_sizes()->push_back(parameters);
    set_num_residuals(static_cast<int>(A_.rows()) + parameters);
  }

  static double Product(int sign, const double* p) {
    return sign == 0 ? p[0] * p[1] : sign * p[0] * p[0];
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    using RowMajor =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const double* p = parameters[0];
    const Eigen::Index rows = A_.rows();
    const int size = parameter_block_sizes()[0];
    Eigen::Map<Vector> residual(residuals, num_residuals());
    residual.head(rows) = b_;
    Eigen::Map<RowMajor> jacobian(
        jacobians != nullptr ? jacobians[0] : nullptr,
        jacobians != nullptr && jacobians[0] != nullptr ? num_residuals() : 0,
        size);
    jacobian.setZero();
    int at = 0;
    for (Eigen::Index j = 0; j < A_.cols(); ++j) {
      const int sign = signs_[static_cast<size_t>(j)];
      residual.head(rows) -= Product(sign, p + at) * A_.col(j);
      if (sign == 0) {
        const double root = std::sqrt(penalty_[j]);
        residual[rows + at] = root * p[at];
        residual[rows + at + 1] = root * p[at + 1];
        if (jacobian.rows() > 0) {
          jacobian.col(at).head(rows) = -p[at + 1] * A_.col(j);
          jacobian.col(at + 1).head(rows) = -p[at] * A_.col(j);
          jacobian(rows + at, at) = root;
          jacobian(rows + at + 1, at + 1) = root;
        }
        at += 2;
      } else {
        const double root = std::sqrt(2.0 * penalty_[j]);
        residual[rows + at] = root * p[at];
        if (jacobian.rows() > 0) {
          jacobian.col(at).head(rows) = -2.0 * sign * p[at] * A_.col(j);
          jacobian(rows + at, at) = root;
        }
        at += 1;
      }
    }
    return true;
  }

 private:
  Matrix A_;
  Vector b_;
  Vector penalty_;
  std::vector<int> signs_;
};

// Solver of one path. All quantities are scaled: z_j = |A_j| g_j / |b|.
class PathSolver {
 public:
  PathSolver(const LeastSquaresSystem& system, const CoefficientMap& map,
             const LassoOptions& options);

  LassoPath Solve();

 private:
  double LambdaMax() const;
  LassoSolution SolveAt(double lambda);
  // Minimises over z from z_, which has its signs, by Levenberg-Marquardt on
  // `working`.
  void Minimize(const std::vector<int>& working, const Vector& penalty,
                LassoSolution* solution);
  // Gives each column at 0 that violates its condition a value. Returns these
  // and the columns not at 0. *num_entered: number of the former.
  std::vector<int> Enter(const Vector& penalty, int* num_entered);
  Vector Gradient() const { return A_.transpose() * (b_ - A_ * z_); }
  // Returns the gradient towards the column's permitted sides.
  double Pull(int j, double gradient) const {
    const int sign = map_.signs()[static_cast<size_t>(j)];
    return sign == 0 ? std::abs(gradient) : sign * gradient;
  }
  // Fills all members but the counters.
  void Report(const Vector& penalty, LassoSolution* solution) const;

  const LeastSquaresSystem& system_;
  const CoefficientMap& map_;
  const LassoOptions& options_;
  Matrix A_;
  Vector b_;
  Vector norms_;
  double size_;     // |b|
  Vector weights_;  // of the scaled columns, times size_
  std::vector<bool> usable_;
  Vector z_;
};

PathSolver::PathSolver(const LeastSquaresSystem& system,
                       const CoefficientMap& map, const LassoOptions& options)
    : system_(system),
      map_(map),
      options_(options),
      A_(system.A),
      b_(system.b),
      norms_(system.A.cols()),
      size_(system.b.norm()),
      weights_(system.A.cols()),
      usable_(static_cast<size_t>(system.A.cols())),
      z_(Vector::Zero(system.A.cols())) {
  if (size_ > 0.0) b_ /= size_;
  Vector weights = Vector::Zero(system.A.cols());
  if (options.penalty_weights.size() > 0) {
    for (int j = 0; j < map.num_coefficients(); ++j) {
      if (map.free(j) < 0) continue;
      weights[map.free(j)] +=
          options.penalty_weights[j] * std::abs(map.factor(j));
    }
  }
  for (Eigen::Index j = 0; j < A_.cols(); ++j) {
    norms_[j] = A_.col(j).norm();
    usable_[static_cast<size_t>(j)] = norms_[j] > 0.0;
    if (norms_[j] == 0.0) norms_[j] = 1.0;
    A_.col(j) /= norms_[j];
    if (options.penalty_weights.size() == 0) weights[j] = norms_[j];
    weights_[j] = weights[j] / norms_[j];
  }
}

double PathSolver::LambdaMax() const {
  const Vector gradient = A_.transpose() * b_;
  double largest = 0.0;
  for (int j = 0; j < static_cast<int>(A_.cols()); ++j) {
    if (!usable_[static_cast<size_t>(j)]) continue;
    largest = std::max(largest, Pull(j, gradient[j]) / weights_[j]);
  }
  return largest * size_;
}

std::vector<int> PathSolver::Enter(const Vector& penalty, int* num_entered) {
  const Vector gradient = Gradient();
  std::vector<int> working;
  *num_entered = 0;
  for (int j = 0; j < static_cast<int>(A_.cols()); ++j) {
    if (z_[j] == 0.0 && usable_[static_cast<size_t>(j)]) {
      const double violation = Pull(j, gradient[j]) - penalty[j];
      if (violation > kEntryTolerance) {
        // Minimum for this column alone.
        z_[j] = gradient[j] > 0.0 ? violation : -violation;
        ++*num_entered;
      }
    }
    if (z_[j] != 0.0) working.push_back(j);
  }
  return working;
}

void PathSolver::Minimize(const std::vector<int>& working,
                          const Vector& penalty, LassoSolution* solution) {
  if (working.empty()) return;
  const auto count = static_cast<Eigen::Index>(working.size());
  Matrix columns(A_.rows(), count);
  Vector penalties(count);
  std::vector<int> signs;
  std::vector<double> parameters;
  for (Eigen::Index i = 0; i < count; ++i) {
    const int j = working[static_cast<size_t>(i)];
    columns.col(i) = A_.col(j);
    penalties[i] = penalty[j];
    signs.push_back(map_.signs()[static_cast<size_t>(j)]);
    parameters.push_back(std::sqrt(std::abs(z_[j])));
    if (signs.back() == 0) {
      parameters.push_back(std::copysign(parameters.back(), z_[j]));
    }
  }
  ceres::Problem problem;
  problem.AddResidualBlock(new ProductCost(columns, b_, penalties, signs),
                           nullptr, parameters.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = options_.max_num_iterations;
  options.function_tolerance = options_.function_tolerance;
  options.gradient_tolerance = 1e-16;
  options.parameter_tolerance = 1e-16;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  solution->num_iterations += static_cast<int>(summary.iterations.size()) - 1;
  int at = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const int sign = signs[static_cast<size_t>(i)];
    z_[working[static_cast<size_t>(i)]] =
        ProductCost::Product(sign, parameters.data() + at);
    at += sign == 0 ? 2 : 1;
  }
}

LassoSolution PathSolver::SolveAt(double lambda) {
  LassoSolution solution;
  solution.lambda = lambda;
  const Vector penalty = lambda / size_ * weights_;
  // Columns that are about to leave tend to zero only in the limit. They are
  // removed if zero is optimal for each by itself.
  const auto drop = [&]() {
    const Vector gradient = Gradient();
    for (int j = 0; j < static_cast<int>(z_.size()); ++j) {
      const double at_zero = gradient[j] + z_[j];
      if (Pull(j, at_zero) <= penalty[j] || at_zero * z_[j] < 0.0) z_[j] = 0.0;
    }
  };
  for (int restart = 0; restart < kMaxRestarts; ++restart) {
    int num_entered = 0;
    const std::vector<int> working = Enter(penalty, &num_entered);
    if (restart > 0 && num_entered == 0) break;
    Minimize(working, penalty, &solution);
    if (options_.polish) break;
    drop();
  }
  if (options_.polish) {
    drop();
    const ActiveSetSolution polished =
        SolveActiveSet(A_, b_, penalty, map_.signs(), z_);
    solution.num_faces = polished.num_faces;
    solution.converged = polished.converged;
    z_ = polished.z;
  } else {
    const Vector gradient = Gradient();
    solution.converged = true;
    for (int j = 0; j < static_cast<int>(z_.size()); ++j) {
      const double off = z_[j] == 0.0
                             ? Pull(j, gradient[j]) - penalty[j]
                             : std::abs(std::abs(gradient[j]) - penalty[j]);
      if (usable_[static_cast<size_t>(j)] &&
          off > kSubgradientTolerance * penalty[j]) {
        solution.converged = false;
      }
    }
  }
  Report(penalty, &solution);
  return solution;
}

void PathSolver::Report(const Vector& penalty, LassoSolution* solution) const {
  const Vector residual = b_ - A_ * z_;
  const Vector gradient = A_.transpose() * residual;
  const double primal =
      0.5 * residual.squaredNorm() + penalty.dot(z_.cwiseAbs());
  double shrink = 1.0;
  std::vector<int> support;
  for (int j = 0; j < static_cast<int>(z_.size()); ++j) {
    if (z_[j] != 0.0) support.push_back(j);
    const double pull = Pull(j, gradient[j]);
    if (usable_[static_cast<size_t>(j)] && pull * shrink > penalty[j]) {
      shrink = penalty[j] / pull;
    }
  }
  const double dual = shrink * residual.dot(b_) -
                      0.5 * shrink * shrink * residual.squaredNorm();
  const double unit = size_ * size_;
  solution->objective = unit * primal + 0.5 * system_.rest;
  solution->duality_gap = std::max(0.0, unit * (primal - dual));
  solution->coefficients = map_.Expand(size_ * z_.cwiseQuotient(norms_));
  solution->support = map_.ExpandSupport(support);
}

LassoPath PathSolver::Solve() {
  LassoPath path;
  path.lambda_max = size_ > 0.0 ? LambdaMax() : 0.0;
  std::vector<double> lambdas = options_.lambdas;
  if (path.lambda_max == 0.0) {
    LassoSolution nothing;
    nothing.objective = 0.5 * (size_ * size_ + system_.rest);
    nothing.coefficients = map_.Expand(z_);
    nothing.converged = true;
    path.solutions.push_back(nothing);
    return path;
  }
  if (lambdas.empty()) {
    for (int i = 0; i < options_.num_lambdas; ++i) {
      const double exponent =
          options_.num_lambdas == 1
              ? 0.0
              : static_cast<double>(i) / (options_.num_lambdas - 1);
      lambdas.push_back(path.lambda_max *
                        std::pow(options_.smallest_ratio, exponent));
    }
  }
  for (double lambda : lambdas) {
    path.solutions.push_back(SolveAt(lambda));
    const int in_model = static_cast<int>((z_.array() != 0.0).count());
    if (options_.max_support > 0 && in_model > options_.max_support) break;
  }
  return path;
}

}  // namespace

bool LassoOptions::IsValid(int num_coefficients, std::string* error) const {
  CHECK(error != nullptr);
  for (size_t i = 0; i < lambdas.size(); ++i) {
    if (!std::isfinite(lambdas[i]) || lambdas[i] <= 0.0 ||
        (i > 0 && lambdas[i] >= lambdas[i - 1])) {
      *error = "LASSO: lambda " + FormatNumber(lambdas[i]) +
               ", expected positive numbers in descending order";
      return false;
    }
  }
  if (lambdas.empty() && num_lambdas < 1) {
    *error = "LASSO: num_lambdas " + std::to_string(num_lambdas) +
             ", expected at least 1";
    return false;
  }
  if (!(smallest_ratio > 0.0 && smallest_ratio < 1.0)) {
    *error = "LASSO: smallest_ratio " + FormatNumber(smallest_ratio) +
             ", expected a number between 0 and 1";
    return false;
  }
  if (penalty_weights.size() != 0 &&
      (penalty_weights.size() != num_coefficients ||
       !penalty_weights.allFinite() || penalty_weights.minCoeff() <= 0.0)) {
    *error = "LASSO: " + std::to_string(penalty_weights.size()) +
             " penalty weights, expected " + std::to_string(num_coefficients) +
             " positive numbers, or none";
    return false;
  }
  if (max_support < 0 || max_num_iterations < 1 ||
      !(function_tolerance > 0.0)) {
    *error = "LASSO: max_support " + std::to_string(max_support) +
             ", max_num_iterations " + std::to_string(max_num_iterations) +
             ", function_tolerance " + FormatNumber(function_tolerance) +
             ", expected at least 0, at least 1 and a positive number";
    return false;
  }
  return true;
}

bool SolveLassoPath(const RegressionProblem& problem,
                    const LassoOptions& options, LassoPath* path,
                    std::string* error) {
  CHECK(path != nullptr && error != nullptr);
  CoefficientMap map;
  if (!problem.IsValid(error, &map) ||
      !options.IsValid(problem.num_coefficients(), error)) {
    return false;
  }
  *path = SolveLassoPath(Condense(problem, map), map, options);
  return true;
}

LassoPath SolveLassoPath(const LeastSquaresSystem& system,
                         const CoefficientMap& map,
                         const LassoOptions& options) {
  CHECK_EQ(system.num_free(), map.num_free());
  std::string error;
  CHECK(options.IsValid(map.num_coefficients(), &error)) << error;
  return PathSolver(system, map, options).Solve();
}

}  // namespace pinode
