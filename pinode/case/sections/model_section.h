// [units] and [model]: the initial model of the structure.

#ifndef PINODE_CASE_SECTIONS_MODEL_SECTION_H_
#define PINODE_CASE_SECTIONS_MODEL_SECTION_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/structure/model/shear_building.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Returns `name` relative to the folder of the case file `case_path`.
std::string ResolvePath(const std::string& case_path, const std::string& name);
// Returns the same for the case of `table`; the name of an array is unchanged.
std::string ResolvePath(const TomlTable& table, const std::string& name);

struct FiniteElementSection;

// Reads the names of DOFs under `dofs`, as other parts of a case can write
// them.
[[nodiscard]] bool ReadDofNames(const TomlTable& table,
                                std::vector<std::string>* names);

[[nodiscard]] bool ReadUnits(const TomlTable& root, UnitSystem* units);

struct ModelSection {
  StructuralModel model;  // valid
  // Shear building, if the case has one: `storey` in a group refers to it.
  std::optional<ShearBuilding> building;
  // Finite-element model from which the matrices come, else null. Groups add
  // their matrices over all DOFs as they are read.
  std::shared_ptr<FiniteElementSection> finite_element;
  std::vector<double> expected_hz;
};

[[nodiscard]] bool ReadModelSection(const TomlTable& root,
                                    const UnitSystem& units,
                                    ModelSection* section);

// Reads the matrix under `key` of `table`: a file's or an array's name, rows
// [[..., ...] or {diagonal = [...]}. It must be num_dofs x num_dofs and finite;
// otherwise the message names the file, or the key. `what` is "the mass
// matrix", ...
[[nodiscard]] bool ReadMatrixKey(const TomlTable& table, const std::string& key,
                                 const std::string& what, int num_dofs,
                                 Matrix* matrix);

// Finds the index of a DOF named in the case file; with `ground_allowed`
// "ground" is -1.
[[nodiscard]] bool FindDof(const StructuralModel& model, const TomlTable& table,
                           const std::string& key, const std::string& name,
                           bool ground_allowed, int* index);

// Reads two different ends from between = ["a", "b"].
[[nodiscard]] bool ReadBetween(const StructuralModel& model,
                               const TomlTable& table, int* from, int* to);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_MODEL_SECTION_H_
