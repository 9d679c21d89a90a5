// Matrices of a finite-element model as a program exports them: large and
// sparse, with DOFs without mass and motions without stiffness.

#ifndef PINODE_STRUCTURE_SPARSE_FINITE_ELEMENT_MODEL_H_
#define PINODE_STRUCTURE_SPARSE_FINITE_ELEMENT_MODEL_H_

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Stores both triangles, for files of one triangle too.
using SparseMatrix = Eigen::SparseMatrix<double>;

// Largest number of DOFs. Larger models are refused before any allocation of
// their size: a wrong size in a file must not exhaust the memory. A direct
// factorisation of a larger model would not fit a workstation.
inline constexpr int kMaxFiniteElementDofs = 2000000;

// Largest number of DOFs of a model stored as full matrices. Condensed models
// are not larger.
inline constexpr int kMaxFullDofs = 20000;

// A whole finite-element model, M a + C v + K x = f, with n DOFs. Units are the
// caller's own and must be consistent.
struct FiniteElementModel {
  // Names of the DOFs: n unique names, in the order of the matrices' rows. They
  // are `node.direction` if the file has them (directions 1 to 3 are
  // translations, 4 to 6 rotations), else u1, u2, ...
  std::vector<std::string> dof_names;

  SparseMatrix mass;       // n x n
  SparseMatrix damping;    // n x n, or 0 x 0 where the export has none
  SparseMatrix stiffness;  // n x n

  // Remarks for the user on the interpretation of the files; sentences.
  std::vector<std::string> notes;

  int num_dofs() const { return static_cast<int>(dof_names.size()); }
  bool has_damping() const { return damping.rows() > 0; }

  // Returns the position of a DOF name, -1 if there is no such name.
  int DofIndex(const std::string& name) const;

  // Checks names (not empty, unique), sizes, finite entries, symmetry (relative
  // 1e-10), and that M is positive semidefinite (relative 1e-10). No DOF may be
  // without both mass and stiffness. K may be singular or indefinite;
  // ComputeLowestModes reports it. The test of M takes up to one sparse
  // factorisation. On failure *error names the matrix, the DOFs and the remedy.
  // *culprit is then the matrix, or null if the DOFs are at fault.
  [[nodiscard]] bool IsValid(std::string* error,
                             const SparseMatrix** culprit = nullptr) const;
};

// Returns the names unchanged if each occurs once. Names that occur several
// times become `name#1`, `name#2`, ... in the order of the rows, so that they
// differ. A sentence in *notes then says so. CalculiX repeats names if it
// expands beams and shells into solids.
std::vector<std::string> NumberRepeatedNames(std::vector<std::string> names,
                                             std::vector<std::string>* notes);

// Returns u1, u2, ..., un.
std::vector<std::string> DefaultDofNames(int num_dofs);

// DOFs that an engineer should know about before trusting a mode. Positions,
// ascending.
struct SpecialDofs {
  // DOFs without an entry in M. They follow the others statically and have no
  // modes.
  std::vector<int> massless;
  // DOFs with a diagonal entry in K that are coupled to nothing in K or M. Many
  // programs leave constrained DOFs in this form (1 or a huge number on the
  // diagonal). With mass, such a DOF has its own mode, sqrt(k / m), that is not
  // a mode of the structure. RemoveDofs removes it.
  std::vector<int> uncoupled;
  // DOFs with mass but no entry in K: unsupported, a mode at 0 Hz.
  std::vector<int> unsupported;
};

// Finds the special DOFs of a valid model.
SpecialDofs FindSpecialDofs(const FiniteElementModel& model);

// Describes the special DOFs in sentences, each with a few of the names. Empty
// if there are none.
std::vector<std::string> DescribeSpecialDofs(const FiniteElementModel& model);

// Returns the model without these DOFs (rows, columns and names), which are
// thereby fixed. Use it to add a support, or to remove constrained DOFs that
// the export left. Positions need not be sorted. CHECKs that they exist and
// that some DOF is left.
FiniteElementModel RemoveDofs(const FiniteElementModel& model,
                              const std::vector<int>& dofs);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_FINITE_ELEMENT_MODEL_H_
