// Roots of Gauss-Newton Hessians, which may be singular.

#ifndef PINODE_ESTIMATE_SOLVER_SQUARE_ROOT_H_
#define PINODE_ESTIMATE_SOLVER_SQUARE_ROOT_H_

#include "pinode/base/types.h"

namespace pinode {

// Finds R (upper triangular) with R'R = H up to a relative diagonal shift no
// larger than needed to make H numerically positive definite. Returns false if
// H is not finite or further from positive semidefinite than rounding explains.
bool SquareRoot(const Matrix& hessian, Matrix* root);

// Finds the same, or the root of the nearest matrix without negative
// eigenvalues. Eliminating the starts of an unstable model's segments may
// remove almost all information. Rounding then leaves directions, and
// diagonals, below zero. Returns false if H is not finite or has no positive
// part.
bool NearestSquareRoot(const Matrix& hessian, Matrix* root);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_SQUARE_ROOT_H_
