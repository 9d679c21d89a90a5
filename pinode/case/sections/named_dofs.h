// Which DOFs a case speaks of: those that a reduction has to keep.

#ifndef PINODE_CASE_SECTIONS_NAMED_DOFS_H_
#define PINODE_CASE_SECTIONS_NAMED_DOFS_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/case/text/toml_value.h"

namespace pinode {

// A DOF's name where a sensor, a load or a term uses it.
struct NamedDof {
  std::string name;
  int line = 0;  // of the case file
};

// Each name once, in the order of the case: `dof` and `combination` of
// channels, `dof` of forces, `between`, features such as "x[u1]" or "d[u1,u2]",
// outputs such as "u1-u2". "ground" is none. `root` are the tables of the
// case; `is_dof` tells whether a DOF
// exists: names may hold a '-', so only it can take a pair apart. Names that do
// not exist are listed as well; what is written wrong is left to its own
// reader.
std::vector<NamedDof> NamedDofs(
    const std::vector<TomlValue::Entry>& root,
    const std::function<bool(const std::string&)>& is_dof);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_NAMED_DOFS_H_
