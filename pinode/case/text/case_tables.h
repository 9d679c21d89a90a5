// Tables that a case file may have.

#ifndef PINODE_CASE_TEXT_CASE_TABLES_H_
#define PINODE_CASE_TEXT_CASE_TABLES_H_

#include "pinode/case/text/toml_table.h"

namespace pinode {

// Refuses tables that no program knows. Each program reads its own and ignores
// the others.
bool AllowCaseTables(const TomlTable& root);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_CASE_TABLES_H_
