// [geometry]: where the structure's nodes are, for pictures of it.

#ifndef PINODE_CASE_GEOMETRY_SECTION_H_
#define PINODE_CASE_GEOMETRY_SECTION_H_

#include <memory>

#include "pinode/case/toml_table.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/study/reduced_structure.h"
#include "pinode/study/structure_picture.h"

namespace pinode {

// *geometry stays null without the section. `structure`: the finite-element
// model of which the dynamics are a reduction, or nullptr.
[[nodiscard]] bool ReadGeometry(
    const TomlTable& root, const StructuralDynamics& dynamics,
    const ReducedStructure* structure,
    std::shared_ptr<const PlacedGeometry>* geometry);

}  // namespace pinode

#endif  // PINODE_CASE_GEOMETRY_SECTION_H_
