#include "pinode/structure/sparse/shifted_factors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pinode/base/double_double.h"
#include "pinode/base/power_of_two.h"
#include "pinode/structure/sparse/doubled_factor.h"

namespace pinode {
namespace {

// Pivots below this count as zero in a matrix with unit diagonal. A beam of a
// thousand elements has 1e-12, and one rounding causes 1e-16.
constexpr double kSmallestPivot = 1e-13;
// Pivot below which small matrices are factorised with 32 digits. The rounding
// of 16 digits, divided by the pivot, is the relative error of the lowest
// eigenvalue, 1e-10 here.
constexpr double kPivotOfDoubled = 1e-6;
// The same limit as kSmallestPivot for K - shift M with 32 digits, where a
// shift that is small beside K leaves small pivots. They are exact to 1e-30.
constexpr double kSmallestShiftedPivot = 1e-22;

// Returns the rounding of each entry of stiffness - shift mass. It is zero
// without a shift. The product is exact with a shift that is a power of two.
SparseMatrix RoundingOf(const SparseMatrix& mass, const SparseMatrix& stiffness,
                        double shift) {
  SparseMatrix rest(stiffness.rows(), stiffness.cols());
  if (shift == 0.0) return rest;
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < mass.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(mass, j); entry; ++entry) {
      const double own = stiffness.coeff(entry.row(), j);
      entries.emplace_back(entry.row(), j,
                           ExactSum(own, -shift * entry.value()).low);
    }
  }
  rest.setFromTriplets(entries.begin(), entries.end());
  return rest;
}

// Returns the pivot of n rows below which it may be rounding of 16 digits. The
// last pivot of a free structure collects the rounding of all rows: 1.1e-13 for
// a chain of 700 masses, which is 0.7 n epsilon.
double SmallestPivot(Eigen::Index n) {
  return std::max(kSmallestPivot, static_cast<double>(n) *
                                      std::numeric_limits<double>::epsilon());
}

void Scale(const Vector& scale, SparseMatrix* matrix) {
  for (Eigen::Index j = 0; j < matrix->outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(*matrix, j); entry; ++entry) {
      entry.valueRef() *= scale[entry.row()] * scale[j];
    }
  }
}

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
    // A power of two rounds no entry.
    scale_[j] = 1.0 / PowerOfTwoBelow(std::sqrt(size));
  }
  Scale(scale_, &shifted);
  return shifted;
}

bool ShiftedFactors::FactoriseDefinite(const SparseMatrix& mass,
                                       const SparseMatrix& stiffness,
                                       double shift) {
  SparseMatrix scaled = ScaledMatrix(mass, stiffness, shift);
  const Eigen::Index n = scaled.rows();
  const bool may_double = n <= kMostDoubled;
  factor_ = MakeDefiniteFactor(n);
  const bool exists = may_double ? factor_->Factorise(scaled)
                                 : factor_->Factorise(std::move(scaled));
  const double least = exists ? factor_->pivots().minCoeff() : 0.0;
  if (!may_double || least > kPivotOfDoubled) return least > SmallestPivot(n);
  SparseMatrix rest = RoundingOf(mass, stiffness, shift);
  Scale(scale_, &rest);
  std::unique_ptr<SparseFactor> doubled = MakeDoubledFactor(scaled, rest);
  if (doubled == nullptr ||
      !(doubled->pivots().minCoeff() >
        (shift == 0.0 ? kSmallestPivot : kSmallestShiftedPivot))) {
    return false;
  }
  factor_ = std::move(doubled);
  return true;
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
