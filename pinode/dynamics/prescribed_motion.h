// DOFs whose motion is prescribed: an actuator moves them, a record says how.

#ifndef PINODE_DYNAMICS_PRESCRIBED_MOTION_H_
#define PINODE_DYNAMICS_PRESCRIBED_MOTION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/linear_dynamics.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// A DOF p of which displacement, velocity and acceleration are inputs. The
// state's entries of p are these inputs; its equation of motion says which
// force moves it. With the mass matrix uncoupled at p, m_p its entry there and
// a_p the acceleration that the structure would give to p if it were let go,
//
//   f_p = m_p (acceleration - a_p),
//
// the force that acts on p beside the measured ones: what a load cell between
// actuator and structure reads.
struct PrescribedDof {
  int dof = 0;
  // Indices into the inputs.
  int displacement = -1;
  int velocity = -1;
  int acceleration = -1;
};

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

// Writes the motion at one instant into a state: T is double or a Jet.
template <typename T>
void PrescribeMotion(const std::vector<PrescribedDof>& prescribed, int num_dofs,
                     const double* input, T* state) {
  for (const PrescribedDof& p : prescribed) {
    state[p.dof] = T(input[p.displacement]);
    state[num_dofs + p.dof] = T(input[p.velocity]);
  }
}

}  // namespace pinode

#endif  // PINODE_DYNAMICS_PRESCRIBED_MOTION_H_
