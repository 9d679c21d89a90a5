// Shear buildings: rigid floors on columns, one DOF per floor.

#ifndef PINODE_STRUCTURE_MODEL_SHEAR_BUILDING_H_
#define PINODE_STRUCTURE_MODEL_SHEAR_BUILDING_H_

#include <string>
#include <vector>

#include "pinode/structure/model/structural_model.h"

namespace pinode {

// A building whose storey i lies between floor i - 1 (the ground for i = 1) and
// floor i, from the ground up:
//
//   K = sum_i k_i e_i e_i',  C = sum_i c_i e_i e_i',  M = diag(m_i),
//
// where e_i is the storey's drift, u_i - u_{i-1} (A. K. Chopra, Dynamics of
// Structures, section 9.1).
struct ShearBuilding {
  std::vector<double> masses;       // of the floors, force time^2 / length
  std::vector<double> stiffnesses;  // of the storeys, force / length
  // Dampers of the storeys, force time / length. Empty: no dampers.
  std::vector<double> dampers;
  // DOF names of the floors. Empty: u1, u2, ...
  std::vector<std::string> dof_names;

  int num_storeys() const { return static_cast<int>(masses.size()); }

  // Checks the building. Masses and storey stiffnesses must be positive, and
  // dampers not negative. All lists must be as long as `masses`.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Builds the model, with one direction "x" that moves all floors alike. C comes
// from the dampers and is zero without them.
[[nodiscard]] bool BuildShearBuilding(const ShearBuilding& building,
                                      StructuralModel* model,
                                      std::string* error);

// Builds a correction group for one storey (1 is the lowest): its part of K or
// C, or the part of its upper floor in M. alpha is the storey's fractional
// change. The group is named k1, c1 or m1 for storey 1. Fails if the building
// is not valid, has no such storey, or if the storey has no such part (no
// damper).
[[nodiscard]] bool StoreyGroup(const ShearBuilding& building,
                               MatrixGroup::Target target, int storey,
                               MatrixGroup* group, std::string* error);

// Builds the StoreyGroup of every storey from the ground up.
[[nodiscard]] bool StoreyGroups(const ShearBuilding& building,
                                MatrixGroup::Target target,
                                std::vector<MatrixGroup>* groups,
                                std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_SHEAR_BUILDING_H_
