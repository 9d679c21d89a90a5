// [geometry]: places of the structure's nodes, for pictures of it.

#ifndef PINODE_CASE_SECTIONS_GEOMETRY_SECTION_H_
#define PINODE_CASE_SECTIONS_GEOMETRY_SECTION_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/case/text/toml_table.h"
#include "pinode/study/picture/structure_picture.h"

namespace pinode {

// Reads the section; *geometry stays null without it. `dofs` and `groups`:
// names that it may place; nullptr: any, if they are not known.
[[nodiscard]] bool ReadGeometry(
    const TomlTable& root, const std::vector<std::string>* dofs,
    const std::vector<std::string>* groups,
    std::shared_ptr<const PlacedGeometry>* geometry);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_GEOMETRY_SECTION_H_
