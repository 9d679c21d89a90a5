// DOFs whose motion is prescribed: an actuator moves them, a record says how.

#ifndef PINODE_DYNAMICS_PRESCRIBED_MOTION_H_
#define PINODE_DYNAMICS_PRESCRIBED_MOTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/linear_dynamics.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Those of `inputs`, in the order of their DOFs; an index stays -1 where an
// input is missing.
std::vector<PrescribedDof> PrescribedDofs(const std::vector<InputSpec>& inputs);

// Whether each of them has its three inputs, once, and a mass of its own.
// `model` and the indices of `inputs` must be valid.
[[nodiscard]] bool ArePrescribable(const StructuralModel& model,
                                   const std::vector<InputSpec>& inputs,
                                   std::string* error);

// The model with those DOFs held: without their rows and columns. May have no
// DOF left.
StructuralModel WithoutPrescribed(const StructuralModel& model,
                                  const std::vector<PrescribedDof>& prescribed);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_PRESCRIBED_MOTION_H_
