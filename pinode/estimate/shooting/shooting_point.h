// The point at which segments are propagated.

#ifndef PINODE_ESTIMATE_SHOOTING_SHOOTING_POINT_H_
#define PINODE_ESTIMATE_SHOOTING_SHOOTING_POINT_H_

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Values of the parameters, and the dynamics prepared for them.
struct ShootingPoint {
  StructuralDynamics::Prepared prepared;
  Vector parameters;  // all of the problem's
};

// Fills *point from the free parameters. False where a parameter is not finite
// or the dynamics cannot be prepared for these values.
[[nodiscard]] bool PreparePoint(const IdentificationProblem& problem,
                                const ParameterLayout& layout,
                                const Vector& free, ShootingPoint* point);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_SHOOTING_POINT_H_
