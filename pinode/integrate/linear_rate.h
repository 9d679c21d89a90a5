// The state equation of linear dynamics as matrices.

#ifndef PINODE_INTEGRATE_LINEAR_RATE_H_
#define PINODE_INTEGRATE_LINEAR_RATE_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// A linear map of state and inputs, and its derivatives with respect to the
// free parameters, in the order of StructuralDynamics' tangent columns.
struct ParameterizedMap {
  Matrix value;
  std::vector<Matrix> derivatives;
};

// Computes [F G] of dh/dt = F h + G u, num_states x (num_states + inputs), for
// dynamics with IsLinear, and its derivatives if requested. Overwrites *map and
// reuses its memory.
void GetLinearRate(const StructuralDynamics& dynamics,
                   const StructuralDynamics::Prepared& prepared,
                   bool with_parameters, ParameterizedMap* map);

// Returns for each state the factor that gives it the unit of a velocity. For
// displacements it is a power of two near the highest frequency. In these units
// |F| is about that frequency. In the original units it is its square, and
// rounding affects slow modes more by the same factor.
Vector VelocityUnits(const Matrix& state_matrix);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_LINEAR_RATE_H_
