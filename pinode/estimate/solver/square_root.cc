#include "pinode/estimate/solver/square_root.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

namespace pinode {
namespace {

Vector UnitDiagonalScale(const Matrix& hessian) {
  return hessian.diagonal().unaryExpr(
      [](double d) { return d > 0.0 ? std::sqrt(d) : 1.0; });
}

// Finds the root of the nearest matrix without negative eigenvalues; false if
// that is zero.
bool RootOfNearest(const Matrix& matrix, Matrix* root) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(matrix);
  if (solver.info() != Eigen::Success) return false;
  const double largest = solver.eigenvalues().maxCoeff();
  if (!(largest > 0.0)) return false;
  const double least = 1e-15 * static_cast<double>(matrix.rows()) * largest;
  const Vector kept = solver.eigenvalues().cwiseMax(least).cwiseSqrt();
  const Matrix rows = kept.asDiagonal() * solver.eigenvectors().transpose();
  *root = Eigen::HouseholderQR<Matrix>(rows)
              .matrixQR()
              .triangularView<Eigen::Upper>();
  for (Eigen::Index i = 0; i < root->rows(); ++i) {
    if ((*root)(i, i) < 0.0) root->row(i) *= -1.0;
  }
  return true;
}

}  // namespace

bool SquareRoot(const Matrix& hessian, Matrix* root) {
  if (!hessian.allFinite()) return false;
  const Eigen::Index n = hessian.rows();
  // Scales to a unit diagonal first: then one small shift suits all units. A
  // parameter without effect keeps a zero row.
  const Vector scale = UnitDiagonalScale(hessian);
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

bool NearestSquareRoot(const Matrix& hessian, Matrix* root) {
  if (SquareRoot(hessian, root)) return true;
  if (!hessian.allFinite()) return false;
  const Vector scale = UnitDiagonalScale(hessian);
  const Vector inverse = scale.cwiseInverse();
  const Matrix scaled = inverse.asDiagonal() * hessian * inverse.asDiagonal();
  if (!RootOfNearest(scaled, root)) return false;
  *root = *root * scale.asDiagonal();
  return root->allFinite();
}

}  // namespace pinode
