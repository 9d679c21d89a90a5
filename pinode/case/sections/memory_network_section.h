// [[network]] with the key `memory`.

#ifndef PINODE_CASE_SECTIONS_MEMORY_NETWORK_SECTION_H_
#define PINODE_CASE_SECTIONS_MEMORY_NETWORK_SECTION_H_

#include <string>

#include "pinode/case/sections/terms_section.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Adds the network with memory in `table` to *dynamics, as a law (see
// MemoryNetwork).
[[nodiscard]] bool ReadMemoryNetwork(const TomlTable& table,
                                     const std::string& name,
                                     const TermsContext& context,
                                     StructuralDynamics* dynamics);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_MEMORY_NETWORK_SECTION_H_
