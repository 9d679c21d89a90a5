// Shear buildings: rigid floors on columns, one DOF a floor.

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
// e_i the storey's drift, u_i - u_{i-1} (A. K. Chopra, Dynamics of Structures,
// section 9.1).
struct ShearBuilding {
  std::vector<double> masses;       // of the floors, force time^2 / length
  std::vector<double> stiffnesses;  // of the storeys, force / length
  // Of the storeys, force time / length; empty for none.
  std::vector<double> dampers;
  // Of the floors; u1, u2, ... if empty.
  std::vector<std::string> dof_names;

  int num_storeys() const { return static_cast<int>(masses.size()); }

  // Masses and storey stiffnesses must be positive, dampers not negative, and
  // all lists as long as `masses`.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// The model, with one direction "x" that moves all floors alike. C is that of
// the dampers, zero without them.
[[nodiscard]] bool BuildShearBuilding(const ShearBuilding& building,
                                      StructuralModel* model,
                                      std::string* error);

// The share of one storey (1 is the lowest) in K or C, or of its upper floor in
// M, as a group: alpha is the storey's fractional change. Named k1, c1 or m1
// for storey 1. Fails if the building is not valid, has no such storey, or if
// the storey has nothing of the kind (no damper).
[[nodiscard]] bool StoreyGroup(const ShearBuilding& building,
                               MatrixGroup::Target target, int storey,
                               MatrixGroup* group, std::string* error);

// StoreyGroup of every storey from the ground up.
[[nodiscard]] bool StoreyGroups(const ShearBuilding& building,
                                MatrixGroup::Target target,
                                std::vector<MatrixGroup>* groups,
                                std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_SHEAR_BUILDING_H_
