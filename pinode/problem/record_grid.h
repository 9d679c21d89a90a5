// The instants of a record at which its run looks at the inputs.

#ifndef PINODE_PROBLEM_RECORD_GRID_H_
#define PINODE_PROBLEM_RECORD_GRID_H_

#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/record/excitation.h"

namespace pinode {

// How the record is integrated with these dynamics: exactly where they are
// linear, and by exponential steps where it has some and they suit, unless it
// asks for Runge-Kutta or for a number of its steps.
Integrator IntegratorOf(const StructuralDynamics& dynamics,
                        const IdentificationRecord& record);

// The record's own grid, or that of another excitation (the same samples) in
// its place.
IntegrationGrid GridOf(const StructuralDynamics& dynamics,
                       const IdentificationRecord& record);
IntegrationGrid GridOf(const StructuralDynamics& dynamics,
                       const IdentificationRecord& record,
                       const Excitation& excitation);

}  // namespace pinode

#endif  // PINODE_PROBLEM_RECORD_GRID_H_
