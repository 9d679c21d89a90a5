#include "pinode/case/text/case_tables.h"

namespace pinode {

bool AllowCaseTables(const TomlTable& root) {
  return root.AllowKeys(
      {"title",    "units",           "model",         "group",    "element",
       "library",  "network",         "unknown_force", "record",   "modal",
       "mode",     "options",         "simulate",      "discover", "damage",
       "profiles", "reference_curve", "modes",         "plan",     "geometry"});
}

}  // namespace pinode
