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
// Reads the section. Without it there is no list; without names in it the list
// is empty.
[[nodiscard]] bool ReadProfiles(
    const TomlTable& root, const IdentificationProblem& problem,
    std::optional<std::vector<std::string>>* parameters);
// Reads the section. *noise_is_sigma: the noise of every channel is its own
// `sigma` instead of a percentage.
[[nodiscard]] bool ReadSimulate(const TomlTable& root, double* noise_percent,
                                bool* noise_is_sigma, std::uint64_t* seed);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_OPTIONS_SECTION_H_
