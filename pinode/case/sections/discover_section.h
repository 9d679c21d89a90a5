// [discover]: options of the search for equations.

#ifndef PINODE_CASE_SECTIONS_DISCOVER_SECTION_H_
#define PINODE_CASE_SECTIONS_DISCOVER_SECTION_H_

#include "pinode/case/text/toml_table.h"
#include "pinode/discover/discovery.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Reads the section; without it, options have their defaults. `dynamics` is
// complete: features and outputs are looked up there.
[[nodiscard]] bool ReadDiscover(const TomlTable& root,
                                const StructuralDynamics& dynamics,
                                DiscoveryOptions* options);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_DISCOVER_SECTION_H_
