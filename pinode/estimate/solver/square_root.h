// Roots of Gauss-Newton Hessians, which may be singular.

#ifndef PINODE_ESTIMATE_SOLVER_SQUARE_ROOT_H_
#define PINODE_ESTIMATE_SOLVER_SQUARE_ROOT_H_

#include "pinode/base/types.h"

namespace pinode {

// R (upper triangular) with R'R = H up to a relative diagonal shift no larger
// than needed to make H numerically positive definite. False where H is not
// finite or further from positive semidefinite than rounding makes it.
bool SquareRoot(const Matrix& hessian, Matrix* root);

// The same, or the root of the nearest matrix without negative eigenvalues:
// what the starts of segments of an unstable model take away may be all but all
// there is, and rounding leaves directions, and diagonals, below zero. False
// where H is not finite or has nothing positive.
bool NearestSquareRoot(const Matrix& hessian, Matrix* root);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_SQUARE_ROOT_H_
