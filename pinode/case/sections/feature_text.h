// Features and outputs of terms in the notation of case files.

#ifndef PINODE_CASE_SECTIONS_FEATURE_TEXT_H_
#define PINODE_CASE_SECTIONS_FEATURE_TEXT_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Returns the names of the dynamics' inputs.
std::vector<std::string> InputNames(const StructuralDynamics& dynamics);

// Parses "x[u1]", "v[u1]", "d[u1,u2]", "w[ground,u1]", "t" or "input[name]",
// found under `key` of `table`, which reports errors.
[[nodiscard]] bool ParseFeature(const TomlTable& table, const std::string& key,
                                const StructuralDynamics& dynamics,
                                const std::string& text, Feature* feature);

// Parses "u1", or "u1-u2" (g on u1 and -g on u2), as a column of num_dofs
// entries.
[[nodiscard]] bool ParseOutput(const TomlTable& table, const std::string& key,
                               const StructuralModel& model,
                               const std::string& text, Vector* column);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_FEATURE_TEXT_H_
