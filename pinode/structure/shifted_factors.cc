#include "pinode/structure/shifted_factors.h"

#include <algorithm>
#include <cmath>

namespace pinode {
namespace {

// Pivots of a matrix with unit diagonal below this are taken for zero: a beam
// of a thousand elements has 1e-12, rounding leaves 1e-16.
constexpr double kSmallestPivot = 1e-13;

}  // namespace

bool ShiftedFactors::Factorise(const SparseMatrix& mass,
                               const SparseMatrix& stiffness, double shift) {
  SparseMatrix shifted = stiffness - shift * mass;
  const Eigen::Index n = shifted.rows();
  scale_ = Vector::Zero(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    double largest = 0.0;
    double diagonal = 0.0;
    for (SparseMatrix::InnerIterator entry(shifted, j); entry; ++entry) {
      largest = std::max(largest, std::abs(entry.value()));
      if (entry.row() == j) diagonal = std::abs(entry.value());
    }
    // An indefinite matrix may have small numbers on its diagonal.
    const double size = std::max(diagonal, 1e-6 * largest);
    scale_[j] = size > 0.0 ? 1.0 / std::sqrt(size) : 1.0;
  }
  shifted = SparseMatrix(scale_.asDiagonal() * shifted * scale_.asDiagonal());
  solver_.compute(shifted);
  if (solver_.info() != Eigen::Success) return false;
  pivots_ = solver_.vectorD();
  if (!pivots_.allFinite()) return false;
  root_ = pivots_.cwiseAbs().cwiseSqrt();
  return true;
}

Eigen::Index ShiftedFactors::DofOfPivot(Eigen::Index pivot) const {
  return solver_.permutationPinv().indices()[pivot];
}

bool ShiftedFactors::IsDefinite() const {
  return pivots_.size() > 0 && pivots_.minCoeff() > kSmallestPivot;
}

double ShiftedFactors::SolveError(const SparseMatrix& mass,
                                  const SparseMatrix& stiffness,
                                  double shift) const {
  const Eigen::Index n = mass.rows();
  Vector right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    right[i] = std::sin(1.0 + 1.7 * static_cast<double>(i));
  }
  const Vector x = scale_.cwiseProduct(solver_.solve(right));
  const Vector back =
      scale_.cwiseProduct(Vector(stiffness * x) - shift * Vector(mass * x));
  return (back - right).norm() / right.norm();
}

Matrix ShiftedFactors::Solve(const Matrix& right) const {
  return scale_.asDiagonal() *
         solver_.solve(Matrix(scale_.asDiagonal() * right));
}

Vector ShiftedFactors::ToShape(const Vector& y) const {
  Vector x = y.cwiseQuotient(root_);
  solver_.matrixU().solveInPlace(x);
  x = solver_.permutationPinv() * x;
  return scale_.cwiseProduct(x);
}

Vector ShiftedFactors::FromForce(const Vector& f) const {
  Vector y = solver_.permutationP() * scale_.cwiseProduct(f);
  solver_.matrixL().solveInPlace(y);
  return y.cwiseQuotient(root_);
}

}  // namespace pinode
