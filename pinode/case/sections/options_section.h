// [options], [profiles] and [simulate].

#ifndef PINODE_CASE_SECTIONS_OPTIONS_SECTION_H_
#define PINODE_CASE_SECTIONS_OPTIONS_SECTION_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pinode/case/text/toml_table.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

[[nodiscard]] bool ReadOptions(const TomlTable& root,
                               IdentificationOptions* options);
// Without the section there is no list, and without names in it an empty one.
[[nodiscard]] bool ReadProfiles(
    const TomlTable& root, const IdentificationProblem& problem,
    std::optional<std::vector<std::string>>* parameters);
// *noise_is_sigma: every channel has its own `sigma` for noise, and no per
// cent.
[[nodiscard]] bool ReadSimulate(const TomlTable& root, double* noise_percent,
                                bool* noise_is_sigma, std::uint64_t* seed);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_OPTIONS_SECTION_H_
