// The least cost with one unknown held.

#ifndef PINODE_ESTIMATE_CERTAINTY_HELD_MINIMUM_H_
#define PINODE_ESTIMATE_CERTAINTY_HELD_MINIMUM_H_

#include <functional>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

struct HeldMinimum {
  Vector free;             // num_free, with the held one as it was given
  CondensedSystem system;  // there
  int linearizations = 0;
  bool converged = false;
};

struct HeldOptions {
  int held = -1;  // -1: none is
  // The minimum is found where the cost would fall by less (absolute), or so
  // many iterations are done.
  double tolerance = 0.0;
  int max_iterations = 50;
  // Asked after each, and may be empty.
  std::function<bool()> stop;
};

// Walks to minima of an objective; keeps what one walk says for the next.
class HeldMinimizer {
 public:
  // Both must outlive the object.
  HeldMinimizer(const IdentificationProblem& problem,
                const ParameterLayout& layout, Objective* objective);

  // From `start`, within the bounds, over all free parameters but the held one:
  // Gauss-Newton steps with active sets while they do what they promise, or
  // else Levenberg-Marquardt by Ceres, with steps that bend where the fit's do.
  // False where the cost cannot be had at `start`.
  [[nodiscard]] bool Minimize(const Vector& start, const HeldOptions& options,
                              HeldMinimum* minimum);

  // Of the trust region at the end of the last walk, where steps bend.
  double radius() const { return radius_; }
  void set_radius(double radius) { radius_ = radius; }

 private:
  bool FinishByCeres(const HeldOptions& options, CostPart* cost,
                     HeldMinimum* minimum);

  const ParameterLayout& layout_;
  Objective* objective_;
  bool bends_;
  double radius_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_HELD_MINIMUM_H_
