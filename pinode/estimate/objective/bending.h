// Where a fit's steps bend, and by what.

#ifndef PINODE_ESTIMATE_OBJECTIVE_BENDING_H_
#define PINODE_ESTIMATE_OBJECTIVE_BENDING_H_

#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/solver/bent_cost.h"
#include "pinode/estimate/solver/bounded_cost.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Whether there are networks, and not of time alone: the hidden units of those
// hardly move, and a fit is nearly a linear one.
bool HasNetworksOfState(const IdentificationProblem& problem,
                        const ParameterLayout& layout);

// Valleys of networks bend. Where unknowns have bounds Ceres searches along
// straight lines.
bool BendsSteps(const IdentificationProblem& problem,
                const ParameterLayout& layout);

// Of the trajectories, whose rows are kept, by the unknowns of `bounded`. Both
// must outlive it.
BentCost::Bend BendOf(Objective* objective, const BoundedCost* bounded);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_BENDING_H_
