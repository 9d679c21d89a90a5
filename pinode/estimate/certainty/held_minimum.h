// Minimum of the cost with one unknown held constant.

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
  Vector free;             // num_free, with the held parameter as given
  CondensedSystem system;  // at `free`
  int linearizations = 0;
  bool converged = false;
};

struct HeldOptions {
  int held = -1;  // -1: no parameter is held
  // The minimum is found when the cost would fall by less than this (absolute),
  // or after `max_iterations`.
  double tolerance = 0.0;
  int max_iterations = 50;
  // Called after each iteration; may be empty.
  std::function<bool()> stop;
};

// Finds minima of an objective. Reuses the information of one search in the
// next.
class HeldMinimizer {
 public:
  // Keeps references to all arguments, which must outlive the object.
  HeldMinimizer(const IdentificationProblem& problem,
                const ParameterLayout& layout, Objective* objective);

  // Minimises from `start`, within the bounds, over all free parameters but the
  // held one. Uses Gauss-Newton steps with active sets while they keep their
  // promises, else Levenberg-Marquardt by Ceres, with steps that bend where the
  // fit's do. Returns false if the cost cannot be evaluated at `start`.
  [[nodiscard]] bool Minimize(const Vector& start, const HeldOptions& options,
                              HeldMinimum* minimum);

  // Radius of the trust region at the end of the last search, if steps bend.
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
