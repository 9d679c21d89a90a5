// Roots of Gauss-Newton Hessians, which may be singular.

#ifndef PINODE_ESTIMATE_SQUARE_ROOT_H_
#define PINODE_ESTIMATE_SQUARE_ROOT_H_

#include "pinode/base/types.h"

namespace pinode {

// R (upper triangular) with R'R = H up to a relative diagonal shift no larger
// than needed to make H numerically positive definite. False where H is not
// finite.
bool SquareRoot(const Matrix& hessian, Matrix* root);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SQUARE_ROOT_H_
