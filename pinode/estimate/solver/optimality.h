// Tests for a minimum.

#ifndef PINODE_ESTIMATE_SOLVER_OPTIMALITY_H_
#define PINODE_ESTIMATE_SOLVER_OPTIMALITY_H_

#include "pinode/base/types.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// True if a parameter is at a bound, and a cost with this slope would fall only
// beyond it.
bool IsHeldAtBound(const Parameter& parameter, double value, double slope);

// Finds the best step from `free` on the quadratic model, within the bounds and
// with `held` fixed (-1: none), and the promised decrease of the cost. Returns
// false if the model has no such step.
[[nodiscard]] bool BestStep(const ParameterLayout& layout, const Vector& free,
                            const CondensedSystem& system, int held,
                            Vector* step, double* promise);

// Distance of a point from a minimum within the bounds, free of units.
struct Optimality {
  // Largest cosine of the angle between the residuals and a column of their
  // Jacobian, of unknowns that are not held at a bound: zero at a minimum.
  double cosine = 0.0;
  // Share of the cost that the best step within the bounds on its quadratic
  // model promises to save.
  double promise = 0.0;

  // True if a solver that has ended here, at `cost`, has stalled before a
  // minimum. If `first_cost` has fallen to rounding, the promises are rounding
  // too.
  bool IsStalled(double cost, double first_cost) const;
};
Optimality MeasureOptimality(const ParameterLayout& layout, const Vector& free,
                             const CondensedSystem& system);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_OPTIMALITY_H_
