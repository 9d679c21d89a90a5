// Scales that make the weights of a network free of units.

#ifndef PINODE_STUDY_PROBLEM_NETWORK_SCALES_H_
#define PINODE_STUDY_PROBLEM_NETWORK_SCALES_H_

#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Sets scales of networks from the problem's training records. This applies to
// every network of *dynamics whose weights are drawn, and whose inputs or
// outputs have no scales of their own. It also applies to networks with memory
// that lack a scale: the case's reader refuses learned weights without scales.
// The scales are the sizes of a network's inputs, and of the accelerations (or
// of the forces on the present masses) in the measured motion. Initial weights,
// weight decay and steps then do not depend on the units. Sizes are those of
// GuessStateScales; a displacement or a deformation is scaled by the motion of
// the model's lowest mode there.
//
// `problem`: its records, with `dynamics` as its own or a copy of it. Nothing
// is set without training records, or without motion in them.
void ScaleNetworks(const IdentificationProblem& problem,
                   StructuralDynamics* dynamics);

// True if ScaleNetworks would set scales.
bool HasNetworksToScale(const StructuralDynamics& dynamics);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_NETWORK_SCALES_H_
