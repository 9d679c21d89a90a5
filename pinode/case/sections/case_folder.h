// Writes a case made in memory, with its arrays, as files.

#ifndef PINODE_CASE_SECTIONS_CASE_FOLDER_H_
#define PINODE_CASE_SECTIONS_CASE_FOLDER_H_

#include <string>

#include "pinode/case/text/case_data.h"

namespace pinode {

struct TomlValue;

// Writes a file to the existing `folder` for each array that a text in *tree
// names, and names that file instead.
[[nodiscard]] bool WriteCaseData(const CaseData& data,
                                 const std::string& folder, TomlValue* tree,
                                 std::string* error);

// Writes the case `tree` as <folder>/case.toml, with the files of its arrays in
// the same folder, which is created if it does not exist. Files named relative
// to the case's place (`path`; empty: the working directory) stay there and are
// named relative to `folder`. Returns false, with *error, if this would replace
// the case itself.
[[nodiscard]] bool WriteCaseFolder(const TomlValue& tree, const CaseData& data,
                                   const std::string& path,
                                   const std::string& folder,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_CASE_FOLDER_H_
