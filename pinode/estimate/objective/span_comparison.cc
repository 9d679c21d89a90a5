#include "pinode/estimate/objective/span_comparison.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <limits>
#include <utility>

#include "pinode/base/stable_norm.h"

namespace pinode {
namespace {

// Least singular value of the coefficients for which they have a nearest
// rotation.
constexpr double kLeastStretch = 1e-6;

// Returns the antisymmetric Omega of S Omega + Omega S = M - M', S symmetric.
Matrix RateOfTurn(const Matrix& stretch, const Matrix& m) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(stretch);
  const Matrix& v = solver.eigenvectors();
  const Vector& s = solver.eigenvalues();
  Matrix turned = v.transpose() * (m - m.transpose()) * v;
  for (Eigen::Index i = 0; i < turned.rows(); ++i) {
    for (Eigen::Index j = 0; j < turned.cols(); ++j) {
      turned(i, j) /= s[i] + s[j];
    }
  }
  return v * turned * v.transpose();
}

}  // namespace

SpanComparison::SpanComparison(std::vector<int> set, std::vector<int> dofs,
                               Matrix measured, std::vector<Matrix> roots)
    : set_(std::move(set)),
      dofs_(std::move(dofs)),
      measured_(std::move(measured)),
      roots_(std::move(roots)) {}

bool SpanComparison::Compute(const UndampedModes& modes, std::string* error) {
  const Eigen::Index count = measured_.cols();
  span_ = modes.shapes(dofs_, set_);
  coefficients_.resize(count, count);
  Matrix unit(count, count);
  bool independent = true;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Matrix& root = roots_[static_cast<size_t>(i)];
    const Eigen::ColPivHouseholderQR<Matrix> factor(Matrix(root * span_));
    const Vector wanted = root * measured_.col(i);
    coefficients_.col(i) = Vector(factor.solve(wanted));
    independent = independent && factor.rank() == count;
    unit.col(i) = StableUnit(coefficients_.col(i));
  }
  nearest_ = span_ * coefficients_;
  const Eigen::JacobiSVD<Matrix> svd(unit,
                                     Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!independent || !(svd.singularValues().minCoeff() > kLeastStretch)) {
    *error =
        "modes of the model with nearly one frequency look alike at the "
        "measured DOFs; give their shapes at more DOFs, or only one of them";
    return false;
  }
  turn_ = svd.matrixU() * svd.matrixV().transpose();
  stretch_ = svd.matrixV() * svd.singularValues().asDiagonal() *
             svd.matrixV().transpose();
  squares_ = turn_.transpose() * modes.eigenvalues(set_).asDiagonal() * turn_;
  return true;
}

bool SpanComparison::Differentiate(const UndampedModes& modes,
                                   const Matrix& matrix, bool on_mass,
                                   Slopes* slopes, std::string* error) const {
  const Eigen::Index count = measured_.cols();
  const Vector own = modes.eigenvalues(set_);
  // Change of Phi: parts along the other modes and, for M, the symmetric part
  // that keeps Phi' M Phi = I.
  Matrix along(modes.eigenvalues.size(), count);
  for (Eigen::Index c = 0; c < count; ++c) {
    Vector parts;
    if (!PartsOfSlope(modes, set_[static_cast<size_t>(c)], set_, matrix,
                      on_mass, &parts, error)) {
      return false;
    }
    along.col(c) = parts;
  }
  const Matrix phi = modes.shapes(Eigen::all, set_);
  const Matrix inner = phi.transpose() * (matrix * phi);
  Matrix change = inner;
  if (on_mass) {
    along(set_, Eigen::all) = -0.5 * inner;
    change = -0.5 * (inner * own.asDiagonal());
    change += Matrix(change.transpose());
  }
  const Matrix moved = modes.shapes(dofs_, Eigen::all) * along;

  slopes->nearest.resize(measured_.rows(), count);
  Matrix unit_slopes(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Matrix& root = roots_[static_cast<size_t>(i)];
    const Matrix weighted = root * span_;
    const Vector a = coefficients_.col(i);
    const Vector left = root * (measured_.col(i) - nearest_.col(i));
    const Vector right = (root * moved).transpose() * left -
                         weighted.transpose() * (root * (moved * a));
    const Matrix squares = weighted.transpose() * weighted;
    const Vector da = squares.ldlt().solve(right);
    slopes->nearest.col(i) = moved * a + span_ * da;
    const double norm = StableNorm(a);
    const Vector direction = a / norm;
    unit_slopes.col(i) = (da - direction * direction.dot(da)) / norm;
  }
  const Matrix rate = RateOfTurn(stretch_, turn_.transpose() * unit_slopes);
  slopes->squares =
      turn_.transpose() * change * turn_ + squares_ * rate - rate * squares_;
  return true;
}

}  // namespace pinode
