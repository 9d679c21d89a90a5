// Matrices of a finite-element model as a program exports them. They are large
// and sparse. DOFs may lack mass, and motions may lack stiffness.

#ifndef PINODE_STRUCTURE_SPARSE_FINITE_ELEMENT_MODEL_H_
#define PINODE_STRUCTURE_SPARSE_FINITE_ELEMENT_MODEL_H_

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Sparse matrix. Symmetric matrices are stored with both triangles.
using SparseMatrix = Eigen::SparseMatrix<double>;

// Largest number of DOFs. The factorisation of a larger model would not fit a
// workstation. Larger models are refused before memory is allocated, so that a
// wrong size in a file does not exhaust the memory.
inline constexpr int kMaxFiniteElementDofs = 2000000;

// Largest number of DOFs of a model that is stored as full matrices.
inline constexpr int kMaxFullDofs = 20000;

// Finite-element model M a + C v + K x = f with n DOFs. Units are the caller's
// own and must be consistent.
struct FiniteElementModel {
  // Names of the DOFs: n unique names, in the order of the matrices' rows. They
  // are `node.direction` if the file has names, with directions 1 to 3 for
  // translations and 4 to 6 for rotations. Otherwise they are u1, u2, ...
  std::vector<std::string> dof_names;

  SparseMatrix mass;       // n x n
  SparseMatrix damping;    // n x n; 0 x 0: not exported
  SparseMatrix stiffness;  // n x n

  // Remarks for the user on the interpretation of the files, one sentence each.
  std::vector<std::string> notes;

  int num_dofs() const { return static_cast<int>(dof_names.size()); }
  bool has_damping() const { return damping.rows() > 0; }

  // Returns the index of a DOF name; -1: there is no such name.
  int DofIndex(const std::string& name) const;

  // Checks names (not empty, unique), sizes, finite entries, symmetry (relative
  // 1e-10), and that M is positive semidefinite (relative 1e-10). No DOF may
  // lack both mass and stiffness. K may be singular or indefinite;
  // ComputeLowestModes reports this. The check of M may need a sparse
  // factorisation.
  //
  // On failure returns false, and *error names the matrix, the DOFs and the
  // remedy. *culprit is then the matrix at fault, or null if the DOFs are at
  // fault.
  [[nodiscard]] bool IsValid(std::string* error,
                             const SparseMatrix** culprit = nullptr) const;
};

// Returns the names with a number added to those that occur several times:
// `name#1`, `name#2`, ... in the order of the rows. A sentence in *notes then
// says so. CalculiX repeats names if it expands beams and shells into solids.
std::vector<std::string> NumberRepeatedNames(std::vector<std::string> names,
                                             std::vector<std::string>* notes);

// Returns u1, u2, ..., un.
std::vector<std::string> DefaultDofNames(int num_dofs);

// DOFs that make modes doubtful, as ascending indices.
struct SpecialDofs {
  // DOFs without an entry in M. They follow the other DOFs statically and add
  // no modes.
  std::vector<int> massless;
  // DOFs with a diagonal entry k in K that are coupled to no other DOF in K or
  // M. Many programs leave constrained DOFs in this form, with 1 or a huge
  // number for k. With a mass m, such a DOF has a mode w = sqrt(k / m) that is
  // not a mode of the structure. RemoveDofs removes the DOF.
  std::vector<int> uncoupled;
  // DOFs with mass but without an entry in K. They are unsupported and have a
  // mode at 0 Hz.
  std::vector<int> unsupported;
};

// Finds the special DOFs of a valid model.
SpecialDofs FindSpecialDofs(const FiniteElementModel& model);

// Returns sentences about the special DOFs, each with a few names. Empty if
// there are none.
std::vector<std::string> DescribeSpecialDofs(const FiniteElementModel& model);

// Returns the model without the rows, columns and names of these DOFs, which
// are thereby fixed. Use it to add a support, or to remove constrained DOFs
// that the export has left. Indices need not be sorted. Aborts if an index does
// not exist or no DOF is left.
FiniteElementModel RemoveDofs(const FiniteElementModel& model,
                              const std::vector<int>& dofs);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_FINITE_ELEMENT_MODEL_H_
