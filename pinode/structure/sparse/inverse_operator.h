// The operator whose largest eigenvalues are the lowest modes. Not meant for
// other layers.

#ifndef PINODE_STRUCTURE_SPARSE_INVERSE_OPERATOR_H_
#define PINODE_STRUCTURE_SPARSE_INVERSE_OPERATOR_H_

#include "pinode/base/types.h"
#include "pinode/structure/sparse/shifted_factors.h"

namespace pinode {

// The inverse operator. With K - shift M = F F' positive definite, H = F^-1 M
// F^-T is symmetric and positive semidefinite with eigenvalues 1 / (w^2 -
// shift). Those of massless motions are zero. Unlike the usual (K - shift M)^-1
// M it needs no M-inner product, which would be a seminorm for a singular M.
//
// A shape F^-T y with held DOFs e has e' F^-T y = 0: y is orthogonal to F^-1 e.
// The operator P H P, where P takes these directions away, has the modes with
// the DOFs held, by the factors of the whole.
class InverseOperator {
 public:
  // `held`: n x held DOFs, orthonormal columns that span F^-1 e.
  InverseOperator(const ShiftedFactors& factors, const SparseMatrix& mass,
                  const Matrix& held)
      : factors_(factors), mass_(mass), held_(held) {}

  Eigen::Index rows() const { return mass_.rows(); }

  // Applies it to each column of `y`.
  Matrix Apply(const Matrix& y) const {
    if (held_.cols() == 0) return Image(y);
    return WithoutHeld(Image(WithoutHeld(y)));
  }

 private:
  Matrix Image(const Matrix& y) const {
    return factors_.FromForce(mass_ * factors_.ToShape(y));
  }
  Matrix WithoutHeld(Matrix y) const {
    const Matrix part = held_.transpose() * y;
    y.noalias() -= held_ * part;
    return y;
  }

  const ShiftedFactors& factors_;
  const SparseMatrix& mass_;
  const Matrix& held_;
};

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_INVERSE_OPERATOR_H_
