// DOFs that a case names, which a reduction has to keep.

#ifndef PINODE_CASE_SECTIONS_NAMED_DOFS_H_
#define PINODE_CASE_SECTIONS_NAMED_DOFS_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/case/text/toml_value.h"

namespace pinode {

// Name of a DOF that a sensor, a load or a term uses.
struct NamedDof {
  std::string name;
  int line = 0;  // of the case file
};

// Returns each name once, in the order of the case: `dof` and `combination` of
// channels, `dof` of forces, places of [[frf]], `between`, features such as
// "x[u1]" or "d[u1,u2]", outputs such as "u1-u2". "ground" is not a DOF. `root`
// are the tables of the case. `is_dof` tells if a DOF exists: names may contain
// a '-', so only it can split a pair. Names of DOFs that do not exist are
// listed as well; the section's own reader reports errors.
std::vector<NamedDof> NamedDofs(
    const std::vector<TomlValue::Entry>& root,
    const std::function<bool(const std::string&)>& is_dof);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_NAMED_DOFS_H_
