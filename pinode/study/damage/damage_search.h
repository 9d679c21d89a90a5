// Search for changes of other kinds than changes of groups: places and
// candidates.

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

// Places and kinds of change to search for.
struct DamageSearch {
  // Place of a possible added mass: DOFs that get the same mass, such as the
  // translations of one node.
  struct MassPlace {
    std::string name;
    std::vector<int> dofs;
  };
  // Place of a possible nonlinear force between two DOFs, given as indices.
  // `from` may be Feature::kGround.
  struct SpringPlace {
    std::string name;
    int from = Feature::kGround;
    int to = Feature::kGround;
  };
  std::vector<MassPlace> masses;
  std::vector<SpringPlace> springs;
  // True: searches for a change of damping, of the whole structure and of
  // single modes.
  bool damping = false;
  // True: searches for a change of stiffness that is in no free group. In a
  // small model of springs each spring is examined. Other models are examined
  // as a whole.
  bool stiffness = false;

  // Checks that `model` has the DOFs. On failure returns false, and *error
  // names the place.
  [[nodiscard]] bool IsValid(const StructuralModel& model,
                             std::string* error) const;
};

// Further unknown, zero in the baselines, by which a change is described.
struct ChangeCandidate {
  ChangeSubject subject;
  // Value of the parameter that corresponds to a change of 1. A change of 1 is
  // the mean mass of the place's DOFs, or a force with the RMS of the linear
  // force at the place.
  double unit = 1.0;
  // kMass: mass that a change of 1 adds to each DOF, in the model's unit.
  Vector masses;
  // kDamping, kStiffness: matrix that a change of 1 adds, num_dofs x num_dofs.
  // It is the damping of the whole model or of one mode, or the stiffness of a
  // spring.
  Matrix matrix;
  // kNonlinear: function of the deformation from `from` to `to` and of its
  // rate, as text.
  int from = Feature::kGround;
  int to = Feature::kGround;
  std::string basis;
  std::string library;  // name of the term
};

// Returns the place with the translations of `node`, if DOFs are named
// "node.direction". It has no DOFs if there are none.
DamageSearch::MassPlace PlaceOfMass(const StructuralModel& model,
                                    const std::string& node);

// Returns the places of masses at single DOFs that a fitted channel measures,
// and with at most 40 DOFs those at all others.
std::vector<DamageSearch::MassPlace> PlacesOfMasses(
    const IdentificationProblem& problem);

// Returns the places of springs that are free stiffness groups.
std::vector<DamageSearch::SpringPlace> GroupSprings(
    const StructuralDynamics& dynamics);

// True if `dynamics` has damping but no free damping group. A change of damping
// would then appear as a change of another unknown.
bool HasFixedDamping(const StructuralDynamics& dynamics);

// Returns all places and kinds that the present sensors and groups allow.
DamageSearch LookEverywhere(const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_DAMAGE_SEARCH_H_
