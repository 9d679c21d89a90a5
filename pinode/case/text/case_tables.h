// Which tables a case file may have.

#ifndef PINODE_CASE_TEXT_CASE_TABLES_H_
#define PINODE_CASE_TEXT_CASE_TABLES_H_

#include "pinode/case/text/toml_table.h"

namespace pinode {

// Refuses what no program knows. Each reads its own and leaves the others'.
bool AllowCaseTables(const TomlTable& root);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_CASE_TABLES_H_
