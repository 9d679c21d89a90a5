// Causes that nonlinear forces or many changes together may hide.

#ifndef PINODE_STUDY_DAMAGE_LINEAR_CAUSES_H_
#define PINODE_STUDY_DAMAGE_LINEAR_CAUSES_H_

#include <cstddef>
#include <vector>

#include "pinode/base/types.h"
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
// A damper that was added to one storey was called drag and friction, which
// left 4 and 5 % of the motion unexplained.
std::vector<std::vector<ChangeCandidate>> DampersToTry(
    const StructuralModel& model, const std::vector<ChangeCandidate>& found,
    const std::vector<ChangeCandidate>& candidates);

// Returns true if the symmetric part of `damping` has a negative eigenvalue: a
// motion that gains energy. A damper has no lower bound, for a spring may have
// lost the damping that the model gives it.
bool HasNegativeDamping(const Matrix& damping);

// Returns the likeliest of `explanations` (best first) if it consists of faults
// of sensors, loads or clocks alone, leaves nothing but noise, leaves no
// more than `left_by_changes`, has odds that count against every other kind,
// and has fewer parts than `num_changes`; nullptr else. Only for problems with
// training records: without them Explanation::leaves says nothing.
//
// A force gauge with a gain of 1.1 is the same as 10 % more mass, damping and
// stiffness everywhere: a storey that had lost 15 % was "Damage: k3 (-6.4 %)"
// beside ten such changes.
const Explanation* FaultInsteadOfChanges(
    const std::vector<Explanation>& explanations, size_t num_changes,
    double left_by_changes);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_LINEAR_CAUSES_H_
