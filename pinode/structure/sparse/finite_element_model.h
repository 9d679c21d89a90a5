// The matrices of a finite-element model as a program exports them: large,
// sparse, with DOFs that carry no mass and motions that meet no stiffness.

#ifndef PINODE_STRUCTURE_SPARSE_FINITE_ELEMENT_MODEL_H_
#define PINODE_STRUCTURE_SPARSE_FINITE_ELEMENT_MODEL_H_

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Both triangles are stored, whatever the file had.
using SparseMatrix = Eigen::SparseMatrix<double>;

// Larger models are refused before anything of their size is allocated: a
// wrong size in a file must not take the machine's memory, and a direct
// factorisation of more than this would not fit a workstation.
inline constexpr int kMaxFiniteElementDofs = 2000000;

// And of one that a file holds as a full matrix: larger ones are no condensed
// models.
inline constexpr int kMaxFullDofs = 20000;

// M a + C v + K x = f of a whole finite-element model with n DOFs. Units are
// the caller's own, consistent ones.
struct FiniteElementModel {
  // n unique names, in the order of the matrices' rows: `node.direction` where
  // the file has them (directions 1 to 3 are translations, 4 to 6 rotations),
  // else u1, u2, ...
  std::vector<std::string> dof_names;

  SparseMatrix mass;       // n x n
  SparseMatrix damping;    // n x n, or 0 x 0 where the export has none
  SparseMatrix stiffness;  // n x n

  // What the user should know of how the files were understood; sentences.
  std::vector<std::string> notes;

  int num_dofs() const { return static_cast<int>(dof_names.size()); }
  bool has_damping() const { return damping.rows() > 0; }

  // Position of a name, -1 if there is none such.
  int DofIndex(const std::string& name) const;

  // Checks names (not empty, unique), sizes, finite entries, symmetry (relative
  // 1e-10), that M is positive semidefinite (relative 1e-10) and that no DOF is
  // without both mass and stiffness. K may be singular or indefinite;
  // ComputeLowestModes reports it. The test of M takes up to one sparse
  // factorisation. On failure *error names matrix, DOFs and the remedy, and
  // *culprit is the matrix, null where it is the DOFs.
  [[nodiscard]] bool IsValid(std::string* error,
                             const SparseMatrix** culprit = nullptr) const;
};

// Names as they are if each occurs once. Those that occur several times, as
// CalculiX writes them where it expands beams and shells into solids, become
// `name#1`, `name#2`, ... in the order of the rows, so that none can be taken
// for another; a sentence in *notes then says so.
std::vector<std::string> NumberRepeatedNames(std::vector<std::string> names,
                                             std::vector<std::string>* notes);

// u1, u2, ..., un.
std::vector<std::string> DefaultDofNames(int num_dofs);

// DOFs about which an engineer would want to know before trusting a mode.
// Positions, ascending.
struct SpecialDofs {
  // No entry in M: they follow the others statically and have no modes.
  std::vector<int> massless;
  // A diagonal entry in K and coupled to nothing in K or M: what many programs
  // leave of a constrained DOF (1 or a huge number on the diagonal). With mass,
  // such a DOF has a mode of its own, sqrt(k / m), that is no mode of the
  // structure: RemoveDofs takes it out.
  std::vector<int> uncoupled;
  // Mass but no entry in K: free to fly, a mode at 0 Hz.
  std::vector<int> unsupported;
};

// The model must be valid.
SpecialDofs FindSpecialDofs(const FiniteElementModel& model);

// The same in sentences, each with a few of the names; empty where there is
// nothing special.
std::vector<std::string> DescribeSpecialDofs(const FiniteElementModel& model);

// The model without these DOFs (rows, columns and names), which thereby stand
// still: how a support is put in, or what is left of one taken out. Positions
// need not be sorted; CHECKs that they exist and that some DOF is left.
FiniteElementModel RemoveDofs(const FiniteElementModel& model,
                              const std::vector<int>& dofs);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_FINITE_ELEMENT_MODEL_H_
