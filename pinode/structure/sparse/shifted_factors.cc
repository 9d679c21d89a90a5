#include "pinode/structure/sparse/shifted_factors.h"

#include <algorithm>
#include <cmath>

namespace pinode {
namespace {

// Pivots below this count as zero in a matrix with unit diagonal. A beam of a
// thousand elements has 1e-12, and rounding causes 1e-16.
constexpr double kSmallestPivot = 1e-13;

}  // namespace

SparseMatrix ShiftedFactors::ScaledMatrix(const SparseMatrix& mass,
                                          const SparseMatrix& stiffness,
                                          double shift) {
  SparseMatrix shifted = stiffness;
  if (shift != 0.0) shifted -= shift * mass;
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
  for (Eigen::Index j = 0; j < n; ++j) {
    for (SparseMatrix::InnerIterator entry(shifted, j); entry; ++entry) {
      entry.valueRef() *= scale_[entry.row()] * scale_[j];
    }
  }
  return shifted;
}

bool ShiftedFactors::FactoriseDefinite(const SparseMatrix& mass,
                                       const SparseMatrix& stiffness,
                                       double shift) {
  factor_ = MakeDefiniteFactor(stiffness.rows());
  return factor_->Factorise(ScaledMatrix(mass, stiffness, shift)) &&
         factor_->pivots().minCoeff() > kSmallestPivot;
}

bool ShiftedFactors::Factorise(const SparseMatrix& mass,
                               const SparseMatrix& stiffness, double shift) {
  factor_ = MakeSimplicialFactor();
  return factor_->Factorise(ScaledMatrix(mass, stiffness, shift));
}

double ShiftedFactors::SolveError(const SparseMatrix& mass,
                                  const SparseMatrix& stiffness,
                                  double shift) const {
  const Eigen::Index n = mass.rows();
  Vector right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    right[i] = std::sin(1.0 + 1.7 * static_cast<double>(i));
  }
  const Vector x = scale_.cwiseProduct(Vector(factor_->Solve(right)));
  const Vector back =
      scale_.cwiseProduct(Vector(stiffness * x) - shift * Vector(mass * x));
  return (back - right).norm() / right.norm();
}

Matrix ShiftedFactors::Solve(const Matrix& right) const {
  return scale_.asDiagonal() * factor_->Solve(scale_.asDiagonal() * right);
}

Matrix ShiftedFactors::ToShape(const Matrix& y) const {
  return scale_.asDiagonal() * factor_->SolveUpper(y);
}

Matrix ShiftedFactors::FromForce(const Matrix& force) const {
  return factor_->SolveLower(scale_.asDiagonal() * force);
}

}  // namespace pinode
