// What an engineer brings: the matrices of a finite-element program, by degree
// of freedom, and the corrections to them that an identification may find.

#ifndef PINODE_STRUCTURE_MODEL_STRUCTURAL_MODEL_H_
#define PINODE_STRUCTURE_MODEL_STRUCTURAL_MODEL_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// A linear structure with n degrees of freedom (DOFs) under ground motion,
//
//   M a + C v + K x = -(M r + M_fs) a_g,
//
// x, v, a relative to the ground (R. W. Clough and J. Penzien, Dynamics of
// Structures, 2nd ed., section 12-8; M_fs is what they call the coupling of the
// free and the support DOFs). Units are the caller's own, consistent ones.
//
// Matrices are dense: a model to be identified has tens of DOFs, condensed to
// where its sensors are.
struct StructuralModel {
  // n unique names, in the order of the rows of every matrix.
  std::vector<std::string> dof_names;

  // M, n x n: force time^2 / length (for rotations times length^2).
  Matrix mass;
  // C, n x n: force time / length.
  Matrix damping;
  // K, n x n: force / length.
  Matrix stiffness;

  // Unique names of the directions of ground motion, such as "x".
  std::vector<std::string> directions;
  // r, n x directions: displacement of each DOF when the ground moves by one,
  // statically. Dimensionless (length for rotations).
  Matrix influence;
  // M_fs, n x directions: mass coupling between DOFs and support; zero for
  // lumped masses.
  Matrix support_mass_coupling;

  int num_dofs() const { return static_cast<int>(dof_names.size()); }
  int num_directions() const { return static_cast<int>(directions.size()); }

  // Position of a name, -1 if there is none such.
  int DofIndex(const std::string& name) const;
  int DirectionIndex(const std::string& name) const;

  // Checks names (not empty, unique), sizes, finite entries, symmetry of M, C
  // and K (relative 1e-10), and that M is positive definite. K may be singular
  // (rigid-body modes) or indefinite (negative stiffness); ComputeModes reports
  // both. On failure *error names matrix, DOFs and the remedy.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// A model with these n x n matrices, one direction "x" that moves every DOF
// alike (r = 1) and no mass coupling to the support. Without names the DOFs are
// u1, u2, ... Checks nothing; call IsValid.
StructuralModel MakeStructuralModel(const Matrix& mass, const Matrix& damping,
                                    const Matrix& stiffness,
                                    std::vector<std::string> dof_names = {});

// One correction alpha * matrix to M, C or K: K = K0 + sum_j alpha_j K_j.
struct MatrixGroup {
  enum class Target { kMass, kDamping, kStiffness };

  // Unique among the groups; also the name of the unknown alpha, which is
  // dimensionless.
  std::string name;
  Target target = Target::kStiffness;
  // n x n, symmetric, in the units of its target.
  Matrix matrix;

  // Checks the name, and the matrix for size, finite entries, symmetry
  // (relative 1e-10) and for not being zero, which would leave alpha without
  // effect. `dof_names` are the model's.
  [[nodiscard]] bool IsValid(const std::vector<std::string>& dof_names,
                             std::string* error) const;
};

// "mass", "damping" or "stiffness".
const char* TargetName(MatrixGroup::Target target);
// The reverse; false, with *target untouched, for any other name.
[[nodiscard]] bool ParseTarget(const std::string& name,
                               MatrixGroup::Target* target);

// Checks every group, and that no two share a name.
[[nodiscard]] bool AreGroupsValid(const StructuralModel& model,
                                  const std::vector<MatrixGroup>& groups,
                                  std::string* error);

// The model with alphas[j] * groups[j].matrix added to the group's target; one
// alpha a group.
StructuralModel ApplyGroups(const StructuralModel& model,
                            const std::vector<MatrixGroup>& groups,
                            const Vector& alphas);

// Stiffness matrix (n x n) of one unit spring between two DOFs, or, with -1 for
// either of them, between a DOF and the ground. Its quadratic form is the
// squared deformation; times c it is a damper's matrix as well.
Matrix SpringMatrix(int num_dofs, int dof_a, int dof_b);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_STRUCTURAL_MODEL_H_
