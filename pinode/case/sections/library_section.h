// [[library]]: sparse library terms, as written by pinode_discover.

#ifndef PINODE_CASE_SECTIONS_LIBRARY_SECTION_H_
#define PINODE_CASE_SECTIONS_LIBRARY_SECTION_H_

#include "pinode/case/sections/terms_section.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Adds the library terms of the case to *dynamics. Call it after ReadElements,
// whose laws come first in StructuralDynamics::laws().
[[nodiscard]] bool ReadLibraries(const TomlTable& root,
                                 const TermsContext& context,
                                 StructuralDynamics* dynamics);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_LIBRARY_SECTION_H_
