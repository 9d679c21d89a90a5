// Stiffness of a model that none of its groups describes.

#ifndef PINODE_STUDY_EXPLANATIONS_UNGROUPED_STIFFNESS_H_
#define PINODE_STUDY_EXPLANATIONS_UNGROUPED_STIFFNESS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Largest number of DOFs for which each mass and spring is examined by itself.
// The cost of the score tests grows with the number of candidates.
inline constexpr int kMostPlaces = 40;

// Spring between two DOFs, or a DOF and the ground.
struct Spring {
  int from = Feature::kGround;
  int to = 0;
  double stiffness = 0.0;
};

// Returns the springs of a small model whose stiffness matrix consists of them,
// else none.
std::vector<Spring> SpringsOf(const StructuralModel& model);

// Returns the name of a DOF, or "ground".
std::string PlaceName(const StructuralModel& model, int dof);

// Part of a stiffness matrix that is in no free group.
struct UngroupedStiffness {
  std::string place;  // "u1-u2", or "rest": all that is in no free group
  Matrix matrix;      // num_dofs x num_dofs
  // "the stiffness between u1 and u2"
  std::string what;
};

// Returns the springs of `corrected`, the model at the values of a fit, that
// are no group of `dynamics`; of a matrix that does not consist of springs, all
// of it that is in no free group.
std::vector<UngroupedStiffness> FindUngroupedStiffness(
    const StructuralDynamics& dynamics, const StructuralModel& corrected);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_UNGROUPED_STIFFNESS_H_
