// Systems of equations of information matrices.

#ifndef PINODE_ESTIMATE_INFORMATION_SOLVER_H_
#define PINODE_ESTIMATE_INFORMATION_SOLVER_H_

#include <Eigen/Cholesky>
#include <cmath>

#include "pinode/base/types.h"

namespace pinode {

// Solves with an information matrix whose unknowns have any units.
class InformationSolver {
 public:
  explicit InformationSolver(const Matrix& information)
      : scale_(information.rows()) {
    for (Eigen::Index i = 0; i < scale_.size(); ++i) {
      const double own = information(i, i);
      scale_[i] = own > 0.0 ? 1.0 / std::sqrt(own) : 0.0;
    }
    Matrix scaled = scale_.asDiagonal() * information * scale_.asDiagonal();
    scaled.diagonal().setConstant(1.0 + kRidge);
    factor_.compute(scaled);
  }
  // False where rounding has made it indefinite.
  bool ok() const { return factor_.info() == Eigen::Success; }
  Matrix Solve(const Matrix& right) const {
    return scale_.asDiagonal() *
           factor_.solve(Matrix(scale_.asDiagonal() * right));
  }

 private:
  static constexpr double kRidge = 1e-10;
  Vector scale_;
  Eigen::LLT<Matrix> factor_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_INFORMATION_SOLVER_H_
