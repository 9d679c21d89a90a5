// [model.finite_element] and [model.reduction]: a model as a finite-element
// program exports it, made small enough to be identified.

#ifndef PINODE_CASE_FINITE_ELEMENT_SECTION_H_
#define PINODE_CASE_FINITE_ELEMENT_SECTION_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/toml_table.h"
#include "pinode/structure/finite_element_files.h"
#include "pinode/structure/reduction.h"
#include "pinode/structure/structural_model.h"

namespace pinode {

// What the case keeps of the export beside the reduced matrices.
struct FiniteElementCase {
  // One for each group of the dynamics, in their order.
  struct Group {
    // Over all DOFs of `exported`; 0 x 0 where a group is given for the
    // coordinates alone and has no such matrix.
    SparseMatrix matrix;
    // From exports: a change alpha of the group means 1 + alpha times what the
    // element set contributes, which can be typed into the FE program.
    bool is_element_set = false;
    std::string source;  // the export's path
  };

  FiniteElementFiles files;
  FiniteElementModel exported;  // as the files have it
  std::vector<int> removed_dofs;
  FiniteElementModel model;  // without these; what is reduced

  ReductionOptions options;
  bool is_reduced = false;  // false: all DOFs of `model` are kept
  // The basis is to be taken again where the groups are found to be.
  bool renew_basis = false;
  // The groups of M and K that `basis_at` names, read before the others.
  std::map<std::string, Group> groups_at_basis;
  // M and K of `exported` with the groups at `basis_at`: whose reduction the
  // basis is, and what damping in proportion to them means.
  SparseMatrix mass_at_basis, stiffness_at_basis;
  // Damping without groups over all DOFs of `exported`: its own, or Rayleigh's
  // of the two above; 0 x 0 where it is given for the coordinates alone.
  SparseMatrix damping;
  // Of these: the basis, the modes and what the reduction costs. Its matrices
  // are those of `model` in that basis.
  ReducedModel reduced;
  // T in the order of `exported`, zero rows for what was removed.
  Matrix expansion;

  // Positions in `exported` whose responses are written (`expand`).
  std::vector<int> expanded_dofs;

  std::vector<double> expected_hz;
  // Special DOFs, rigid-body modes, ...: sentences.
  std::vector<std::string> notes;

  std::vector<Group> groups;
};

const char* ReductionMethodName(ReductionMethod method);

// Reads both tables under `table`, [model], of a case with a finite-element
// model; `root` says which DOFs are to be kept. *model receives reduced
// matrices (no damping where the export has none), names and influence vectors.
[[nodiscard]] bool ReadFiniteElementSection(
    const TomlTable& root, const TomlTable& table, const UnitSystem& units,
    std::shared_ptr<FiniteElementCase>* section, StructuralModel* model);

// The group's matrix over all DOFs from `changed_export` and `factor` or from
// `set_export`, and reduced along in group->matrix.
[[nodiscard]] bool ReadExportedGroup(const TomlTable& table,
                                     const FiniteElementCase& section,
                                     MatrixGroup* group,
                                     FiniteElementCase::Group* exported);

// A spring of stiffness `scale` between two of the coordinates (-1: the ground)
// over all DOFs; its matrix is 0 x 0 where an end is a coordinate of a mode.
// Needs no basis yet.
FiniteElementCase::Group SpringGroup(const FiniteElementCase& section,
                                     double scale, int from, int to);

}  // namespace pinode

#endif  // PINODE_CASE_FINITE_ELEMENT_SECTION_H_
