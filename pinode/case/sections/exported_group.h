// Matrices from exports of a finite-element program, and groups from two of
// them.

#ifndef PINODE_CASE_SECTIONS_EXPORTED_GROUP_H_
#define PINODE_CASE_SECTIONS_EXPORTED_GROUP_H_

#include <string>

#include "pinode/case/sections/finite_element_section.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/structure/decks/finite_element_files.h"
#include "pinode/structure/model/structural_model.h"
#include "pinode/study/reduction/reduced_structure.h"

namespace pinode {

// Reads a file under `key`: "name", or {file = "name", variable = "K"}.
[[nodiscard]] bool ReadSource(const TomlTable& table, const std::string& key,
                              MatrixSource* source);

// Reads the group's matrix over all DOFs from `changed_export` and `factor` or
// from `set_export`.
[[nodiscard]] bool ReadSetMatrix(const TomlTable& table,
                                 const FiniteElementSection& section,
                                 MatrixGroup::Target target,
                                 ReducedStructure::Group* exported);

// Reads the same, and the reduced matrix into group->matrix.
[[nodiscard]] bool ReadExportedGroup(const TomlTable& table,
                                     const FiniteElementSection& section,
                                     MatrixGroup* group,
                                     ReducedStructure::Group* exported);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_EXPORTED_GROUP_H_
