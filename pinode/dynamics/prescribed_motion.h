// DOFs with prescribed motion: an actuator moves them, and a record gives the
// motion.

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

// Checks that each prescribed DOF has each of its three inputs once, and a mass
// that is not coupled to others. `model` and the indices of `inputs` must be
// valid.
[[nodiscard]] bool ArePrescribable(const StructuralModel& model,
                                   const std::vector<InputSpec>& inputs,
                                   std::string* error);

// Returns the model with those DOFs fixed: without their rows and columns. It
// may have no DOF left.
StructuralModel WithoutPrescribed(const StructuralModel& model,
                                  const std::vector<PrescribedDof>& prescribed);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_PRESCRIBED_MOTION_H_
