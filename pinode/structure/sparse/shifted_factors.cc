#include "pinode/structure/sparse/shifted_factors.h"

#include <metis.h>

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>
#include <vector>

namespace pinode {
namespace {

// Pivots below this count as zero in a matrix with unit diagonal. A beam of a
// thousand elements has 1e-12, and rounding causes 1e-16.
constexpr double kSmallestPivot = 1e-13;
// Number of rows below which both orders are fast, and METIS is the slower one.
constexpr Eigen::Index kNestedFrom = 2000;

// Finds the order from the neighbours of each row (without the row itself).
// Returns false if METIS finds no order.
bool NestedDissection(
    const SparseMatrix& symmetric,
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>* inverse) {
  idx_t size = static_cast<idx_t>(symmetric.rows());
  std::vector<idx_t> begins = {0};
  std::vector<idx_t> neighbours;
  begins.reserve(static_cast<size_t>(size) + 1);
  neighbours.reserve(static_cast<size_t>(symmetric.nonZeros()));
  for (Eigen::Index j = 0; j < symmetric.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(symmetric, j); entry; ++entry) {
      if (entry.row() != j) {
        neighbours.push_back(static_cast<idx_t>(entry.row()));
      }
    }
    begins.push_back(static_cast<idx_t>(neighbours.size()));
  }
  if (neighbours.empty()) return false;
  std::vector<idx_t> order(static_cast<size_t>(size));
  std::vector<idx_t> places(static_cast<size_t>(size));
  if (METIS_NodeND(&size, begins.data(), neighbours.data(), nullptr, nullptr,
                   order.data(), places.data()) != METIS_OK) {
    return false;
  }
  inverse->resize(size);
  for (idx_t i = 0; i < size; ++i) {
    inverse->indices()[i] = static_cast<int>(order[static_cast<size_t>(i)]);
  }
  return true;
}

}  // namespace

void FillReducingOrdering::operator()(
    const SparseMatrix& symmetric,
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>& inverse)
    const {
  if (symmetric.rows() < kNestedFrom ||
      !NestedDissection(symmetric, &inverse)) {
    Eigen::AMDOrdering<int>()(symmetric, inverse);
  }
}

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
