#include "pinode/case/text/case_tables.h"

namespace pinode {

bool AllowCaseTables(const TomlTable& root) { return root.AllowKeys(); }

}  // namespace pinode
