// Causes that nonlinear forces or many changes together may hide.

#ifndef PINODE_STUDY_DAMAGE_LINEAR_CAUSES_H_
#define PINODE_STUDY_DAMAGE_LINEAR_CAUSES_H_

#include <cstddef>
#include <vector>

#include "pinode/problem/verdict.h"
#include "pinode/structure/model/structural_model.h"
#include "pinode/study/damage/damage_search.h"

namespace pinode {

// Returns sets of changes with dampers to try. If there are nonlinear forces
// among `found`, the only set has a damper at each of their places instead of
// them. Otherwise each set has `found` and a damper at one of the springs of
// `candidates`, if these are at most eight. A change of 1 is a damper that
// gives its spring the ratio of the first mode.
//
// A damper that was added to one storey was called drag and friction: these
// left 4 and 5 % of the motion.
std::vector<std::vector<ChangeCandidate>> DampersToTry(
    const StructuralModel& model, const std::vector<ChangeCandidate>& found,
    const std::vector<ChangeCandidate>& candidates);

// Returns the likeliest of `explanations` (best first) if it consists of faults
// of sensors, loads or clocks alone, leaves nothing but noise, has odds that
// count against every other kind, and has fewer parts than `num_changes`;
// nullptr else.
//
// A force gauge with a gain of 1.1 is the same as 10 % more mass, damping and
// stiffness everywhere: a storey that had lost 15 % was "Damage: k3 (-6.4 %)"
// beside ten such changes.
const Explanation* FaultInsteadOfChanges(
    const std::vector<Explanation>& explanations, size_t num_changes);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_LINEAR_CAUSES_H_
