// Number of Runge-Kutta steps that a sampling interval needs.

#ifndef PINODE_INTEGRATE_STEP_CHOICE_H_
#define PINODE_INTEGRATE_STEP_CHOICE_H_

#include <string>

#include "pinode/base/types.h"
#include "pinode/integrate/integrator.h"

namespace pinode {

// Smallest number of substeps for which every decaying eigenvalue of
// `state_matrix` (num_states x num_states) stays inside the stability region
// with some margin: |dt lambda| <= 2.5.
int StableSubsteps(const Matrix& state_matrix, double sampling_step);

// Returns the stability with the given number of substeps.
StabilityReport CheckStability(const Matrix& state_matrix, double sampling_step,
                               int substeps);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_STEP_CHOICE_H_
