// [options] and [simulate].

#ifndef PINODE_CASE_OPTIONS_SECTION_H_
#define PINODE_CASE_OPTIONS_SECTION_H_

#include <cstdint>

#include "pinode/case/toml_table.h"
#include "pinode/estimate/identification_options.h"

namespace pinode {

[[nodiscard]] bool ReadOptions(const TomlTable& root,
                               IdentificationOptions* options);
[[nodiscard]] bool ReadSimulate(const TomlTable& root, double* noise_percent,
                                std::uint64_t* seed);

}  // namespace pinode

#endif  // PINODE_CASE_OPTIONS_SECTION_H_
