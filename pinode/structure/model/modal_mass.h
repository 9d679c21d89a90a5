// Mass that takes part in each mode when the ground moves.

#ifndef PINODE_STRUCTURE_MODEL_MODAL_MASS_H_
#define PINODE_STRUCTURE_MODEL_MODAL_MASS_H_

#include "pinode/base/types.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Participation of modes in each direction of ground motion. With the influence
// r, the mass coupling M_fs to the support and a shape of phi' M phi = 1:
//
//   participation  Gamma = phi' (M r + M_fs)
//   effective mass Gamma^2
//
// The effective masses of all modes add up to the moving mass, which is r' M r
// for lumped masses and without the mass of the supports (A. K. Chopra,
// Dynamics of Structures, section 13.2).
struct ModalMasses {
  Matrix participation;  // modes x directions; root of mass
  Matrix effective;      // modes x directions; mass
  Vector moving;         // (M r + M_fs)' M^-1 (M r + M_fs), per direction

  // Returns the effective masses as fractions of the moving ones; NaN in
  // directions that move nothing.
  Matrix Shares() const;
};

// Returns the masses of mass-normalised shapes, DOFs x modes, of a valid model.
ModalMasses EffectiveModalMasses(const StructuralModel& model,
                                 const Matrix& shapes);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_MODAL_MASS_H_
