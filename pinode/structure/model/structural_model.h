// Structural model: the matrices of a finite-element program, by degree of
// freedom, and the corrections to them that an identification may find.

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
// Structures, 2nd ed., section 12-8; they call M_fs the coupling of the free
// and the support DOFs). Units are the caller's own and must be consistent.
//
// Matrices are dense: a model to be identified has tens of DOFs, condensed to
// the places of its sensors.
struct StructuralModel {
  // Names of the DOFs: n unique names, in the order of the rows of every
  // matrix.
  std::vector<std::string> dof_names;

  // M, n x n: force time^2 / length (for rotations times length^2).
  Matrix mass;
  // C, n x n: force time / length.
  Matrix damping;
  // K, n x n: force / length.
  Matrix stiffness;

  // Unique names of the directions of ground motion, such as "x".
  std::vector<std::string> directions;
  // r, n x directions: static displacement of each DOF when the ground moves by
  // one. Dimensionless (length for rotations).
  Matrix influence;
  // M_fs, n x directions: mass coupling between DOFs and support; zero for
  // lumped masses.
  Matrix support_mass_coupling;

  int num_dofs() const { return static_cast<int>(dof_names.size()); }
  int num_directions() const { return static_cast<int>(directions.size()); }

  // Returns the position of a DOF name, -1 if there is no such name.
  int DofIndex(const std::string& name) const;
  int DirectionIndex(const std::string& name) const;

  // Checks names (not empty, unique), sizes, finite entries, symmetry of M, C
  // and K (relative 1e-10), and that M is positive definite. K may be singular
  // (rigid-body modes) or indefinite (negative stiffness); ComputeModes reports
  // both. On failure *error names the matrix, the DOFs and the remedy.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Returns a model with these n x n matrices, one direction "x" that moves every
// DOF alike (r = 1) and no mass coupling to the support. Without names the DOFs
// are u1, u2, ... Checks nothing; call IsValid.
StructuralModel MakeStructuralModel(const Matrix& mass, const Matrix& damping,
                                    const Matrix& stiffness,
                                    std::vector<std::string> dof_names = {});

// One correction alpha * matrix to M, C or K: K = K0 + sum_j alpha_j K_j.
struct MatrixGroup {
  enum class Target { kMass, kDamping, kStiffness };

  // Name, unique among the groups. It is also the name of the unknown alpha,
  // which is dimensionless.
  std::string name;
  Target target = Target::kStiffness;
  // Matrix of the group, n x n, symmetric, in the units of its target.
  Matrix matrix;

  // Checks the name, and the matrix for size, finite entries and symmetry
  // (relative 1e-10). The matrix must not be zero, because alpha would have no
  // effect. `dof_names` are the model's.
  [[nodiscard]] bool IsValid(const std::vector<std::string>& dof_names,
                             std::string* error) const;
};

// Returns "mass", "damping" or "stiffness".
const char* TargetName(MatrixGroup::Target target);
// Parses such a name. Returns false, with *target unchanged, for any other
// name.
[[nodiscard]] bool ParseTarget(const std::string& name,
                               MatrixGroup::Target* target);

// Checks every group, and that no two have the same name.
[[nodiscard]] bool AreGroupsValid(const StructuralModel& model,
                                  const std::vector<MatrixGroup>& groups,
                                  std::string* error);

// Returns the model with alphas[j] * groups[j].matrix added to the group's
// target. There is one alpha per group.
StructuralModel ApplyGroups(const StructuralModel& model,
                            const std::vector<MatrixGroup>& groups,
                            const Vector& alphas);

// Returns the stiffness matrix (n x n) of one unit spring between two DOFs, or
// between a DOF and the ground if one of them is -1. Its quadratic form is the
// squared deformation. Multiplied by c it is also the matrix of a damper.
Matrix SpringMatrix(int num_dofs, int dof_a, int dof_b);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_STRUCTURAL_MODEL_H_
