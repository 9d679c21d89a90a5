// Minimum of a quadratic model within bounds.

#ifndef PINODE_ESTIMATE_SOLVER_BOUNDED_STEP_H_
#define PINODE_ESTIMATE_SOLVER_BOUNDED_STEP_H_

#include "pinode/base/types.h"

namespace pinode {

// Finds d that minimises g'd + d'Hd / 2 with lower <= d <= upper, where the
// bounds (infinite: none) enclose zero. H (symmetric, positive semidefinite)
// may be singular by rounding: its diagonal then gets a relative shift. Uses a
// primal active-set method (J. Nocedal and S. J. Wright, Numerical
// Optimization, 2006, section 16.5), from d = 0. Returns false if a number is
// not finite.
[[nodiscard]] bool BoundedStep(const Matrix& hessian, const Vector& gradient,
                               const Vector& lower, const Vector& upper,
                               Vector* step);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_BOUNDED_STEP_H_
