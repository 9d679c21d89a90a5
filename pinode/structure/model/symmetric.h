// Symmetry of matrices: the distance from it, and the nearest symmetric matrix.

#ifndef PINODE_STRUCTURE_MODEL_SYMMETRIC_H_
#define PINODE_STRUCTURE_MODEL_SYMMETRIC_H_

#include "pinode/base/types.h"

namespace pinode {

// Largest asymmetry of a matrix that counts as symmetric. It is far above the
// rounding of assembly or condensation in double precision, and far below any
// intended asymmetry.
inline constexpr double kSymmetryTolerance = 1e-10;

// The pair of entries (row, column), (column, row) that differ most.
struct Asymmetry {
  // |a_ij - a_ji| / max(|a_ij|, |a_ji|, sqrt|a_ii a_jj|). The scale is local,
  // so that an error among small rotational entries is not hidden by large
  // translational ones.
  double relative = 0.0;
  int row = 0;
  int column = 0;
};

// Returns the worst pair of a square matrix of finite entries. `relative` is
// exactly zero if and only if the matrix equals its transpose.
Asymmetry LargestAsymmetry(const Matrix& matrix);

// Returns (A + A') / 2, the nearest symmetric matrix to the square matrix A in
// the Frobenius norm.
Matrix SymmetricPart(const Matrix& matrix);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_SYMMETRIC_H_
