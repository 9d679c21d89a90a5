// Largest eigenvalues of a symmetric operator. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_BLOCK_LANCZOS_H_
#define PINODE_STRUCTURE_SPARSE_BLOCK_LANCZOS_H_

#include <functional>

#include "pinode/base/types.h"

namespace pinode {

// Applies an operator to the columns of a matrix.
using BlockOperator = std::function<Matrix(const Matrix&)>;

struct BlockLanczosOptions {
  // Number of eigenvalues.
  int count = 1;
  // Number of columns to which the operator is applied at a time, at least 1.
  // A group of at most so many equal eigenvalues is found as a whole.
  int block = 4;
  // Largest residual in parts of the eigenvalue.
  double tolerance = 1e-11;
  // Most applications of the operator to a block.
  int max_steps = 300;
  // Seed of the start.
  unsigned seed = 1;
};

struct LargestEigenpairs {
  Vector values;     // descending
  Matrix vectors;    // n x count, orthonormal
  Vector residuals;  // |A x - value x| / value; converged or not
  int steps = 0;     // applications of the operator to a block
};

// Computes the largest eigenvalues of a symmetric positive semidefinite
// operator of n rows. Columns of `found`, n x k, are orthonormal eigenvectors
// that are left out. There may be fewer eigenvalues than asked if the rest of
// the operator is zero.
//
// The method is block Lanczos with full orthogonalisation and thick restarts,
// from a random start (G. H. Golub, R. Underwood, The block Lanczos method for
// computing eigenvalues, Mathematical Software III, 1977; K. Wu, H. Simon,
// Thick-restart Lanczos method, SIAM J. Matrix Anal. 22, 2000).
LargestEigenpairs BlockLanczos(Eigen::Index n, const BlockOperator& apply,
                               const Matrix& found,
                               const BlockLanczosOptions& options);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_BLOCK_LANCZOS_H_
