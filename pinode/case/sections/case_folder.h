// Writes a case that was made in memory, with its arrays, as files.

#ifndef PINODE_CASE_SECTIONS_CASE_FOLDER_H_
#define PINODE_CASE_SECTIONS_CASE_FOLDER_H_

#include <string>

#include "pinode/case/text/case_data.h"

namespace pinode {

struct TomlValue;

// Writes to `folder`, which is there, a file for each array that a text in
// *tree names, and names that file instead.
[[nodiscard]] bool WriteCaseData(const CaseData& data,
                                 const std::string& folder, TomlValue* tree,
                                 std::string* error);

// Writes the case that `tree` says as <folder>/case.toml, with the files of its
// arrays beside it; `folder` is created where it is not there. Files that it
// names, from where it is (`path`; empty: the working directory), stay where
// they are and are named as seen from `folder`. False, with *error, where that
// would take the place of the case itself.
[[nodiscard]] bool WriteCaseFolder(const TomlValue& tree, const CaseData& data,
                                   const std::string& path,
                                   const std::string& folder,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_CASE_FOLDER_H_
