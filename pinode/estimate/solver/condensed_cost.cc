#include "pinode/estimate/solver/condensed_cost.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "pinode/base/stopwatch.h"
#include "pinode/estimate/solver/square_root.h"

namespace pinode {

CondensedCost::CondensedCost(CostPart* part, int num_free) : part_(part) {
  mutable_parameter_block_sizes()->push_back(num_free);
  set_num_residuals(num_free + 1);
}

bool CondensedCost::EvaluateWithJacobian(const Vector& free, double* residuals,
                                         double* jacobian) const {
  const Eigen::Index n = free.size();
  if (!part_->Linearize(free, &system_) ||
      !NearestSquareRoot(system_.hessian, &root_)) {
    return false;
  }
  Vector projected = system_.gradient;
  root_.transpose().triangularView<Eigen::Lower>().solveInPlace(projected);
  Eigen::Map<Vector> r(residuals, n + 1);
  r.head(n) = projected;
  // Rounding, or a shifted root, must not give a negative remainder.
  r[n] = std::sqrt(std::max(0.0, 2.0 * system_.cost - projected.squaredNorm()));
  Eigen::Map<
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      rows(jacobian, n + 1, n);
  rows.topRows(n) = root_;
  rows.bottomRows(1).setZero();
  return projected.allFinite();
}

bool CondensedCost::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  const int n = parameter_block_sizes()[0];
  const Vector free = Eigen::Map<const Vector>(parameters[0], n);
  const auto begin = std::chrono::steady_clock::now();
  bool ok;
  if (jacobians == nullptr || jacobians[0] == nullptr) {
    double cost = 0.0;
    ok = part_->Evaluate(free, &cost);
    std::fill(residuals, residuals + n, 0.0);
    residuals[n] = std::sqrt(2.0 * std::max(0.0, cost));
  } else {
    ok = EvaluateWithJacobian(free, residuals, jacobians[0]);
  }
  if (!ok) ++failed_evaluations_;
  jacobian_seconds_ += SecondsSince(begin);
  return ok;
}

ceres::LinearSolverType DenseSolverFor(int num_free) {
  constexpr int kMostForQr = 100;
  return num_free <= kMostForQr ? ceres::DENSE_QR
                                : ceres::DENSE_NORMAL_CHOLESKY;
}

}  // namespace pinode
