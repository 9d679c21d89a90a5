// Conditions under which a fit's steps bend, and the bend itself.

#ifndef PINODE_ESTIMATE_OBJECTIVE_BENDING_H_
#define PINODE_ESTIMATE_OBJECTIVE_BENDING_H_

#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/solver/bent_cost.h"
#include "pinode/estimate/solver/bounded_cost.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// True if there are networks of the state. Networks of time alone do not count:
// their hidden units hardly move, and such a fit is nearly linear.
bool HasNetworksOfState(const IdentificationProblem& problem,
                        const ParameterLayout& layout);

// True if steps bend, as valleys of networks do. With bounds Ceres searches
// along straight lines.
bool BendsSteps(const IdentificationProblem& problem,
                const ParameterLayout& layout);

// Returns the bend of the trajectories, whose rows are kept, by the unknowns of
// `bounded`. Both must outlive it.
BentCost::Bend BendOf(Objective* objective, const BoundedCost* bounded);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_BENDING_H_
