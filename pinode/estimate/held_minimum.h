// The least cost with one unknown held.

#ifndef PINODE_ESTIMATE_HELD_MINIMUM_H_
#define PINODE_ESTIMATE_HELD_MINIMUM_H_

#include <functional>

#include "pinode/base/types.h"
#include "pinode/estimate/cost_part.h"
#include "pinode/estimate/parameter_layout.h"

namespace pinode {

struct HeldMinimum {
  Vector free;             // num_free, with the held one as it was given
  CondensedSystem system;  // there
  int linearizations = 0;
  bool converged = false;
};

// From `start`, within the bounds, over all free parameters but `held` (-1:
// none is): Gauss-Newton steps with active sets while they do what they
// promise, or else Levenberg-Marquardt by Ceres, until the cost would fall by
// less than `tolerance` (absolute) or so many iterations are done. `stop` (may
// be empty) is asked after each. False where the cost cannot be had at `start`.
[[nodiscard]] bool MinimizeHolding(const ParameterLayout& layout, int held,
                                   const Vector& start, double tolerance,
                                   int max_iterations,
                                   const std::function<bool()>& stop,
                                   CostPart* cost, HeldMinimum* minimum);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_HELD_MINIMUM_H_
