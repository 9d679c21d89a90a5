// Search for other kinds of change than those of groups: places and candidates.

#ifndef PINODE_STUDY_DAMAGE_DAMAGE_SEARCH_H_
#define PINODE_STUDY_DAMAGE_DAMAGE_SEARCH_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/damage/verdict.h"
#include "pinode/dynamics/feature.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

struct DamageSearch {
  // Place of a possible added mass: these DOFs together, the translations of
  // one node.
  struct MassPlace {
    std::string name;
    std::vector<int> dofs;
  };
  // Place of a possible nonlinear force between these two, of which `to` is a
  // DOF.
  struct SpringPlace {
    std::string name;
    int from = Feature::kGround;
    int to = Feature::kGround;
  };
  std::vector<MassPlace> masses;
  std::vector<SpringPlace> springs;
  // Look for a change of the model's damping, of the whole and of single modes.
  bool damping = false;
  // Look for a change of stiffness that is in no free group: of each spring of
  // a small model of springs, of others as a whole.
  bool stiffness = false;

  // Checks that `model` has the DOFs. On failure *error names the place.
  [[nodiscard]] bool IsValid(const StructuralModel& model,
                             std::string* error) const;
};

// Unknown that was zero in the model and may have changed.
struct ChangeCandidate {
  ChangeSubject subject;
  // Unit of the change in terms of the parameter: 1 is the mean mass of the
  // place's DOFs, or a force with the RMS of the linear one at the place.
  double unit = 1.0;
  // kMass: mass per DOF added by a change of 1, in the model's unit of mass.
  Vector masses;
  // kDamping, kStiffness: what is added by a change of 1, num_dofs x num_dofs:
  // all damping that the model has, or that of a mode; the stiffness of a
  // spring.
  Matrix matrix;
  // kNonlinear: a function of the deformation from `from` to `to` and its rate.
  int from = Feature::kGround;
  int to = Feature::kGround;
  std::string basis;
  std::string library;  // the name of the term
};

// Returns the DOFs of `model` that are translations of `node`, if names are
// "node.direction"; empty if there is no such DOF.
DamageSearch::MassPlace PlaceOfMass(const StructuralModel& model,
                                    const std::string& node);

// Returns masses at DOFs that a fitted channel measures alone.
std::vector<DamageSearch::MassPlace> MeasuredMasses(
    const IdentificationProblem& problem);

// Returns springs at free stiffness groups that are one spring.
std::vector<DamageSearch::SpringPlace> GroupSprings(
    const StructuralDynamics& dynamics);

// True if `dynamics` has damping, of which no group is free: then its change
// would be put down to what is.
bool HasFixedDamping(const StructuralDynamics& dynamics);

// Returns all of them: all places that the present sensors and groups allow.
DamageSearch LookEverywhere(const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_DAMAGE_SEARCH_H_
