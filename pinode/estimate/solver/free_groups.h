// Free corrections of M, C and K, with matrices of low rank.

#ifndef PINODE_ESTIMATE_SOLVER_FREE_GROUPS_H_
#define PINODE_ESTIMATE_SOLVER_FREE_GROUPS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// A group of the model whose factor is free.
struct FreeGroup {
  int free = -1;  // position among the free parameters
  std::string name;
  MatrixGroup::Target target = MatrixGroup::Target::kStiffness;
  // The group's matrix is left right^T, num_dofs x rank. If it has full rank,
  // it is `left` itself, and `right` is empty.
  Matrix left, right;
};

// Returns the free groups that follow nothing in `dynamics`. Groups that are
// tied are one group.
std::vector<FreeGroup> FindFreeGroups(const StructuralDynamics& dynamics,
                                      const ParameterLayout& layout);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_FREE_GROUPS_H_
