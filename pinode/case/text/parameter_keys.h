// Keys that describe one unknown in a case file.

#ifndef PINODE_CASE_TEXT_PARAMETER_KEYS_H_
#define PINODE_CASE_TEXT_PARAMETER_KEYS_H_

#include <string>
#include <vector>

#include "pinode/base/parameter_block.h"
#include "pinode/case/text/toml_table.h"

namespace pinode {

// Overwrites the fields of *parameter that `table` gives. Other fields are
// unchanged, except that the prior's mean becomes the initial value. Numbers in
// the file are multiplied by `factor` (not zero; a negative one exchanges the
// bounds). A parameter that is tied to another one has no other keys; its value
// is set when all parameters are known. Refuses crossed bounds, bounds beyond
// those in *parameter, and a value outside.
[[nodiscard]] bool ReadParameterKeys(const TomlTable& table, double factor,
                                     Parameter* parameter);

// Checks a name that may become part of a file's name: letters, digits, '_',
// '-', '.' and '+', not beginning with a point.
[[nodiscard]] bool CheckName(const TomlTable& table, const std::string& key,
                             const std::string& name);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_PARAMETER_KEYS_H_
