// Whether a point is a minimum.

#ifndef PINODE_ESTIMATE_SOLVER_OPTIMALITY_H_
#define PINODE_ESTIMATE_SOLVER_OPTIMALITY_H_

#include "pinode/base/types.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Whether a parameter is at a bound, and a cost with this slope would fall only
// beyond it.
bool IsHeldAtBound(const Parameter& parameter, double value, double slope);

// The best step from `free` on its quadratic model, within the bounds and with
// `held` (-1: none) where it is, and by how much it promises to lower the cost.
// False where the model has none.
[[nodiscard]] bool BestStep(const ParameterLayout& layout, const Vector& free,
                            const CondensedSystem& system, int held,
                            Vector* step, double* promise);

// How far from a minimum within the bounds a point is, free of units.
struct Optimality {
  // The largest cosine of the angle between the residuals and a column of their
  // Jacobian, of unknowns that are not held at a bound: zero at a minimum.
  double cosine = 0.0;
  // The share of the cost that the best step within the bounds on its quadratic
  // model promises to save.
  double promise = 0.0;

  // Whether a solver that has ended here, at `cost`, has come to a halt rather
  // than to a minimum. Where `first_cost` has fallen to rounding the promises
  // are rounding, too.
  bool IsStalled(double cost, double first_cost) const;
};
Optimality MeasureOptimality(const ParameterLayout& layout, const Vector& free,
                             const CondensedSystem& system);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_OPTIMALITY_H_
