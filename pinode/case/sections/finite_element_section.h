// [model.finite_element] and [model.reduction]: a model exported by a
// finite-element program, reduced for an identification.

#ifndef PINODE_CASE_SECTIONS_FINITE_ELEMENT_SECTION_H_
#define PINODE_CASE_SECTIONS_FINITE_ELEMENT_SECTION_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/structure/decks/finite_element_files.h"
#include "pinode/structure/model/structural_model.h"
#include "pinode/structure/sparse/reduction.h"
#include "pinode/study/reduction/reduced_structure.h"

namespace pinode {

// The export and its reduction.
struct FiniteElementSection {
  FiniteElementFiles files;
  // Groups of M and K that `basis_at` names, read before the others.
  std::map<std::string, ReducedStructure::Group> groups_at_basis;
  ReducedStructure structure;
};

const char* ReductionMethodName(ReductionMethod method);

// Reads both tables under `table`, [model], of a case with a finite-element
// model; `root` determines the DOFs to be kept. The structure is ready for
// MakeReducedModel but for the damping rule.
[[nodiscard]] bool ReadFiniteElementSection(
    const TomlTable& root, const TomlTable& table, const UnitSystem& units,
    std::shared_ptr<FiniteElementSection>* section);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_FINITE_ELEMENT_SECTION_H_
