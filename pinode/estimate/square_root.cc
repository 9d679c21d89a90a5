#include "pinode/estimate/square_root.h"

#include <Eigen/Cholesky>
#include <cmath>

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

}  // namespace pinode
