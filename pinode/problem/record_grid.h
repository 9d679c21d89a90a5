// Integration grid of a record: the instants at which a run evaluates the
// inputs.

#ifndef PINODE_PROBLEM_RECORD_GRID_H_
#define PINODE_PROBLEM_RECORD_GRID_H_

#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/record/excitation.h"

namespace pinode {

// Returns the integrator of the record for these dynamics. Linear dynamics are
// integrated exactly. Exponential steps are used where the dynamics allow them
// and they suit, unless the record asks for Runge-Kutta or for a number of its
// steps.
Integrator IntegratorOf(const StructuralDynamics& dynamics,
                        const IdentificationRecord& record);

// Return the record's own grid, or the grid of another excitation with the same
// samples.
IntegrationGrid GridOf(const StructuralDynamics& dynamics,
                       const IdentificationRecord& record);
IntegrationGrid GridOf(const StructuralDynamics& dynamics,
                       const IdentificationRecord& record,
                       const Excitation& excitation);

}  // namespace pinode

#endif  // PINODE_PROBLEM_RECORD_GRID_H_
