// Table of the keys of a structure file. The reader accepts what it lists, and
// the reference in README.md is printed from it.

#ifndef PINODE_WATCH_STRUCTURE_KEYS_H_
#define PINODE_WATCH_STRUCTURE_KEYS_H_

#include <string>
#include <vector>

#include "pinode/case/text/case_keys.h"

namespace pinode {

const std::vector<CaseTable>& StructureTables();

// Returns the names of the keys of the table at `path`.
std::vector<std::string> StructureKeys(const std::string& path);

// Returns the keys of all tables in Markdown.
std::string StructureKeyReference();

}  // namespace pinode

#endif  // PINODE_WATCH_STRUCTURE_KEYS_H_
