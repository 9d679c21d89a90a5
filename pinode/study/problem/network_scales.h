// Scales that make a network's weights numbers without units.

#ifndef PINODE_STUDY_PROBLEM_NETWORK_SCALES_H_
#define PINODE_STUDY_PROBLEM_NETWORK_SCALES_H_

#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Gives every network of *dynamics whose weights are drawn, and whose inputs or
// outputs have no scales of their own, scales from the problem's training
// records: how large its inputs are, and the accelerations (or the forces on
// the masses at hand) of the motion that was measured. First weights, weight
// decay and steps then mean the same whatever the units. Sizes are those of
// GuessStateScales; a displacement or a deformation is the larger the more the
// model's lowest mode moves there.
//
// `problem`: its records, with `dynamics` as its own or a copy of it. Without
// training records, or where nothing in them moves, nothing is set.
void ScaleNetworks(const IdentificationProblem& problem,
                   StructuralDynamics* dynamics);

// Whether ScaleNetworks would look at any.
bool HasNetworksToScale(const StructuralDynamics& dynamics);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_NETWORK_SCALES_H_
