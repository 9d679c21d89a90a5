#include "pinode/estimate/condensed_cost.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "pinode/base/logging.h"

namespace pinode {

bool SquareRoot(const Matrix& hessian, Matrix* root) {
  if (!hessian.allFinite()) return false;
  const Eigen::Index n = hessian.rows();
  // Unit diagonal first: then one small shift suits all units. A parameter
  // without effect keeps a zero row.
  Vector scale(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double d = hessian(i, i);
    scale[i] = d > 0.0 ? std::sqrt(d) : 1.0;
  }
  const Vector inverse = scale.cwiseInverse();
  for (double shift = 1e-15; shift < 1e-3; shift *= 10.0) {
    *root = inverse.asDiagonal() * hessian * inverse.asDiagonal();
    root->diagonal().array() += shift * static_cast<double>(n);
    const Eigen::LLT<Eigen::Ref<Matrix>, Eigen::Upper> factor(*root);
    if (factor.info() == Eigen::Success) {
      for (Eigen::Index j = 0; j < n; ++j) {
        root->col(j).head(j + 1) *= scale[j];
        root->col(j).tail(n - j - 1).setZero();
      }
      return root->allFinite();
    }
  }
  return false;
}

CondensedCost::CondensedCost(MultipleShooting* shooting, int num_free)
    : shooting_(shooting) {
  mutable_parameter_block_sizes()->push_back(num_free);
  set_num_residuals(num_free + 1);
}

bool CondensedCost::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  const int n = parameter_block_sizes()[0];
  const Vector free = Eigen::Map<const Vector>(parameters[0], n);
  Eigen::Map<Vector> r(residuals, n + 1);
  const auto begin = std::chrono::steady_clock::now();
  bool ok;
  if (jacobians == nullptr || jacobians[0] == nullptr) {
    double cost = 0.0;
    ok = shooting_->Evaluate(free, &cost);
    r.setZero();
    r[n] = std::sqrt(2.0 * std::max(0.0, cost));
  } else {
    Matrix& root = root_;
    ok = shooting_->Linearize(free, &system_) &&
         SquareRoot(system_.hessian, &root);
    if (ok) {
      Vector projected = system_.gradient;
      root.transpose().triangularView<Eigen::Lower>().solveInPlace(projected);
      // Rounding, or a shifted root, must not turn into a negative rest.
      const double total = 2.0 * system_.cost;
      r.head(n) = projected;
      r[n] = std::sqrt(std::max(0.0, total - projected.squaredNorm()));
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic,
                               Eigen::RowMajor>>
          jacobian(jacobians[0], n + 1, n);
      jacobian.topRows(n) = root;
      jacobian.bottomRows(1).setZero();
      ok = projected.allFinite();
    }
  }
  if (!ok) ++failed_evaluations_;
  jacobian_seconds_ +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
          .count();
  return ok;
}

}  // namespace pinode
