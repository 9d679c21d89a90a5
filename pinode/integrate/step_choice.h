// How many Runge-Kutta steps a sampling interval needs.

#ifndef PINODE_INTEGRATE_STEP_CHOICE_H_
#define PINODE_INTEGRATE_STEP_CHOICE_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {

// RK4 is stable where |R(z)| <= 1, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24 (E.
// Hairer and G. Wanner, Solving Ordinary Differential Equations II, IV.2).
struct StabilityReport {
  // max |lambda| of the linearised state matrix, rad/s (1/s).
  double largest_eigenvalue = 0.0;
  // Largest growth factor max |R(dt lambda)| over the modes that should not
  // grow; 1 is the limit.
  double growth = 0.0;
  int substeps = 1;
  double step = 0.0;  // s
  bool stable = false;
};

// Smallest number of substeps for which every decaying eigenvalue of
// `state_matrix` (num_states x num_states) stays inside the stability region
// with some margin: |dt lambda| <= 2.5.
int StableSubsteps(const Matrix& state_matrix, double sampling_step);

// What happens with the number of substeps given.
StabilityReport CheckStability(const Matrix& state_matrix, double sampling_step,
                               int substeps);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_STEP_CHOICE_H_
