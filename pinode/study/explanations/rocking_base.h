// Building whose base rocks on a flexible ground.

#ifndef PINODE_STUDY_EXPLANATIONS_ROCKING_BASE_H_
#define PINODE_STUDY_EXPLANATIONS_ROCKING_BASE_H_

#include <optional>

#include "pinode/base/types.h"
#include "pinode/structure/model/structural_model.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

// Heights of the DOFs above the base, in storeys, where `model` is a building
// of equal storeys: its stiffness consists of springs, one from the ground to
// the lowest DOF and one from each DOF to the next above, in any order of
// numbers. Empty: it is not. So it is with a spring from the ground to a higher
// DOF, such as a tie at the roof, and with one that skips a storey.
Vector HeightsOfStoreys(const StructuralModel& model);

// Returns the stiffness that a rotation of the base takes away, per unit of its
// share s. With a base that has no moment of inertia, on a spring R against
// rotation, and heights h, the stiffness K of the DOFs becomes
//
//   K - s (K h) (K h)' / (h' K h),   s = h' K h / (R + h' K h)
//
// (static condensation of the rotation).
Matrix RockingPerShare(const Matrix& stiffness, const Vector& heights);

// Returns the suspect of a rocking base for `model`. Its unknown is s, between
// 0 and 1. Its matrix is that of the stiffness of `model`: make it again where
// a fit has changed this. Nothing if the model has no HeightsOfStoreys, or less
// than three: a rotation under two DOFs fits almost any error of a stiffness.
std::optional<Suspect> MakeRockingBase(const StructuralModel& model);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_ROCKING_BASE_H_
