// Linear systems of information matrices.

#ifndef PINODE_ESTIMATE_SOLVER_INFORMATION_SOLVER_H_
#define PINODE_ESTIMATE_SOLVER_INFORMATION_SOLVER_H_

#include <Eigen/Cholesky>
#include <cmath>

#include "pinode/base/types.h"

namespace pinode {

// Solves with an information matrix whose unknowns have any units.
class InformationSolver {
 public:
  InformationSolver(const InformationSolver&) = delete;
  InformationSolver& operator=(const InformationSolver&) = delete;
  explicit InformationSolver(const Matrix& information)
      : scale_(ScaleOf(information)),
        scaled_(Scaled(information, scale_)),
        factor_(scaled_) {}
  // False if rounding has made the matrix indefinite.
  bool ok() const { return factor_.info() == Eigen::Success; }
  Matrix Solve(const Matrix& right) const {
    return scale_.asDiagonal() *
           factor_.solve(Matrix(scale_.asDiagonal() * right));
  }

 private:
  static constexpr double kRidge = 1e-10;

  static Vector ScaleOf(const Matrix& information) {
    Vector scale(information.rows());
    for (Eigen::Index i = 0; i < scale.size(); ++i) {
      const double own = information(i, i);
      scale[i] = own > 0.0 ? 1.0 / std::sqrt(own) : 0.0;
    }
    return scale;
  }
  static Matrix Scaled(const Matrix& information, const Vector& scale) {
    Matrix scaled = scale.asDiagonal() * information * scale.asDiagonal();
    scaled.diagonal().setConstant(1.0 + kRidge);
    return scaled;
  }

  const Vector scale_;
  Matrix scaled_;
  // Factored in place: two copies would be large.
  Eigen::LLT<Eigen::Ref<Matrix>> factor_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_INFORMATION_SOLVER_H_
