// [damage]: what may have changed beside the groups, and where.

#ifndef PINODE_CASE_DAMAGE_SECTION_H_
#define PINODE_CASE_DAMAGE_SECTION_H_

#include <string>
#include <vector>

#include "pinode/case/toml_table.h"
#include "pinode/dynamics/feature.h"
#include "pinode/estimate/identification_problem.h"

namespace pinode {

// Where pinode_damage looks for other kinds of change than those of groups.
struct DamageSearch {
  // A mass may have been added to these DOFs together, the translations of one
  // node.
  struct MassPlace {
    std::string name;
    std::vector<int> dofs;
  };
  // A nonlinear force may have appeared between these two.
  struct SpringPlace {
    std::string name;
    int from = Feature::kGround;
    int to = Feature::kGround;
  };
  std::vector<MassPlace> masses;
  std::vector<SpringPlace> springs;
};

// Without the section: masses where a fitted channel measures one DOF, springs
// where a free stiffness group is one spring. `problem` is complete.
[[nodiscard]] bool ReadDamage(const TomlTable& root,
                              const IdentificationProblem& problem,
                              DamageSearch* search);

}  // namespace pinode

#endif  // PINODE_CASE_DAMAGE_SECTION_H_
