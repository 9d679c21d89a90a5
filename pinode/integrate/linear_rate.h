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
// with IsLinear. The derivatives only where they are asked for.
ParameterizedMap LinearRate(const StructuralDynamics& dynamics,
                            const StructuralDynamics::Prepared& prepared,
                            bool with_parameters);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_LINEAR_RATE_H_
