// The state equation of linear dynamics as matrices.

#ifndef PINODE_INTEGRATE_LINEAR_RATE_H_
#define PINODE_INTEGRATE_LINEAR_RATE_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// A linear map of state and inputs, and its derivatives by the free parameters
// in the order of StructuralDynamics' tangent columns.
struct ParameterizedMap {
  Matrix value;
  std::vector<Matrix> derivatives;
};

// [F G] of dh/dt = F h + G u, num_states x (num_states + inputs), for dynamics
// with IsLinear. The derivatives only where they are asked for. What *map holds
// is overwritten, in the memory that it has.
void GetLinearRate(const StructuralDynamics& dynamics,
                   const StructuralDynamics::Prepared& prepared,
                   bool with_parameters, ParameterizedMap* map);

// For each state what it is to be multiplied by to have the unit of a velocity:
// displacements by a power of two near the highest frequency. In these units
// |F| is about that frequency, in its own its square, and what rounding does to
// slow modes is as much less.
Vector VelocityUnits(const Matrix& state_matrix);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_LINEAR_RATE_H_
