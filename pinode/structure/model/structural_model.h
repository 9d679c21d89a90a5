// Structural model: mass, damping and stiffness matrices, and corrections to
// them that an identification may find.

#ifndef PINODE_STRUCTURE_MODEL_STRUCTURAL_MODEL_H_
#define PINODE_STRUCTURE_MODEL_STRUCTURAL_MODEL_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Linear structure with n degrees of freedom (DOFs) under ground motion,
//
//   M a + C v + K x = -(M r + M_fs) a_g,
//
// with x, v, a relative to the ground and a_g the acceleration of the ground
// (R. W. Clough and J. Penzien, Dynamics of Structures, 2nd ed., 1993, section
// 12-8). M_fs is the mass coupling between the free DOFs and the supports.
// Units are the caller's own and must be consistent.
//
// Matrices are dense, because a model to be identified has tens of DOFs. Larger
// models are reduced first (reduction.h).
struct StructuralModel {
  // Names of the DOFs: n unique names, in the order of the rows of every
  // matrix.
  std::vector<std::string> dof_names;

  // Mass M, n x n, symmetric positive definite. Unit: force time^2 / length;
  // times length^2 for rotations.
  Matrix mass;
  // Damping C, n x n, symmetric. Unit: force time / length.
  Matrix damping;
  // Stiffness K, n x n, symmetric. Unit: force / length.
  Matrix stiffness;

  // Unique names of the directions of ground motion, such as "x".
  std::vector<std::string> directions;
  // Influence r, n x directions: static displacement of each DOF for a unit
  // displacement of the ground. Dimensionless if the ground translates.
  Matrix influence;
  // Mass coupling M_fs, n x directions, in units of mass. Zero for lumped
  // masses.
  Matrix support_mass_coupling;

  int num_dofs() const { return static_cast<int>(dof_names.size()); }
  int num_directions() const { return static_cast<int>(directions.size()); }

  // Return the index of a name; -1: there is no such name.
  int DofIndex(const std::string& name) const;
  int DirectionIndex(const std::string& name) const;

  // Checks names (not empty, unique), sizes, finite entries, symmetry of M, C
  // and K (relative 1e-10), and that M is positive definite. K may be singular
  // (rigid-body modes) or indefinite (negative stiffness); ComputeModes reports
  // both. On failure returns false, and *error names the matrix, the DOFs and
  // the remedy.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Returns a model with these n x n matrices. It has one direction, "x", that
// moves all DOFs equally (r = 1), and no mass coupling to the support. Without
// names the DOFs are u1, u2, ... The function checks nothing; call IsValid.
StructuralModel MakeStructuralModel(const Matrix& mass, const Matrix& damping,
                                    const Matrix& stiffness,
                                    std::vector<std::string> dof_names = {});

// Correction alpha * matrix of M, C or K, such as K = K0 + sum_j alpha_j K_j.
struct MatrixGroup {
  enum class Target { kMass, kDamping, kStiffness };

  // Name, unique among the groups. It is also the name of the unknown alpha.
  std::string name;
  Target target = Target::kStiffness;
  // Matrix of the group, n x n, symmetric, in the units of its target.
  Matrix matrix;

  // Checks the name, and the matrix for size, finite entries and symmetry
  // (relative 1e-10). The matrix must not be zero, because alpha would have no
  // effect. `dof_names` are those of the model. On failure returns false, with
  // a sentence in *error.
  [[nodiscard]] bool IsValid(const std::vector<std::string>& dof_names,
                             std::string* error) const;
};

// Returns "mass", "damping" or "stiffness".
const char* TargetName(MatrixGroup::Target target);
// Parses such a name. For any other text returns false and leaves *target
// unchanged.
[[nodiscard]] bool ParseTarget(const std::string& name,
                               MatrixGroup::Target* target);

// Checks every group, and that no two have the same name. On failure returns
// false, with a sentence in *error.
[[nodiscard]] bool AreGroupsValid(const StructuralModel& model,
                                  const std::vector<MatrixGroup>& groups,
                                  std::string* error);

// Returns the model with alphas[j] * groups[j].matrix added to the target of
// each group. `alphas` has one entry per group.
StructuralModel ApplyGroups(const StructuralModel& model,
                            const std::vector<MatrixGroup>& groups,
                            const Vector& alphas);

// Returns the stiffness matrix (num_dofs x num_dofs) of a spring with unit
// stiffness between two DOFs. -1 stands for the ground. Multiplied by c it is
// also the matrix of a damper.
Matrix SpringMatrix(int num_dofs, int dof_a, int dof_b);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_STRUCTURAL_MODEL_H_
