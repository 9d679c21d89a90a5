#include "pinode/discover/quadratic_face.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

namespace pinode {
namespace {

// Largest remainder of a dependent column, as a share of its square, after
// projection on those taken.
constexpr double kDependent = 1e-9;

}  // namespace

Vector UnitDiagonalScales(const QuadraticCost& cost) {
  Vector scales = Vector::Zero(cost.gradient.size());
  for (Eigen::Index j = 0; j < scales.size(); ++j) {
    const double curvature = cost.hessian(j, j);
    if (curvature > 0.0) scales[j] = 1.0 / std::sqrt(curvature);
  }
  return scales;
}

QuadraticCost ScaledCost(const QuadraticCost& cost, const Vector& scales) {
  QuadraticCost scaled;
  scaled.gradient = cost.gradient.cwiseProduct(scales);
  scaled.hessian = scales.asDiagonal() * cost.hessian * scales.asDiagonal();
  return scaled;
}

QuadraticFace::QuadraticFace(const QuadraticCost& scaled,
                             std::vector<int> support)
    : support_(std::move(support)) {
  const Eigen::Index size = static_cast<Eigen::Index>(support_.size());
  slopes_ = scaled.gradient;
  curvatures_ = scaled.hessian.diagonal();
  if (size == 0) return;
  Matrix rows(size, scaled.gradient.size());
  Matrix hessian(size, size);
  Vector gradient(size);
  for (Eigen::Index a = 0; a < size; ++a) {
    rows.row(a) = scaled.hessian.row(At(a));
    gradient[a] = scaled.gradient[At(a)];
  }
  for (Eigen::Index a = 0; a < size; ++a) hessian.col(a) = rows.col(At(a));
  const Eigen::LDLT<Matrix> factor(hessian);
  solution_ = -factor.solve(gradient);
  inverse_diagonal_ = factor.solve(Matrix::Identity(size, size)).diagonal();
  explained_ = factor.solve(rows);
  slopes_ += rows.transpose() * solution_;
  curvatures_ -= rows.cwiseProduct(explained_).colwise().sum().transpose();
  twice_cost_ = gradient.dot(solution_);
}

double QuadraticFace::Gain(int j, Eigen::Index a, double* value) const {
  double slope = slopes_[j];
  double curvature = curvatures_[j];
  if (a >= 0) {
    const double share = explained_(a, j) / inverse_diagonal_[a];
    slope -= share * solution_[a];
    curvature += share * explained_(a, j);
  }
  *value = 0.0;
  if (!(curvature > kDependent)) return 0.0;
  *value = -slope / curvature;
  return slope * slope / curvature;
}

}  // namespace pinode
