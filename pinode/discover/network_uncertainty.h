// How well records determine what a network says.

#ifndef PINODE_DISCOVER_NETWORK_UNCERTAINTY_H_
#define PINODE_DISCOVER_NETWORK_UNCERTAINTY_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/trajectory_samples.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Standard deviation of the outputs y of each network of `problem` along
// `samples`, from the posterior covariance of the weights w,
//
//   sigma_y^2 = (dy/dw) H^-1 (dy/dw)',
//
// H being the Gauss-Newton Hessian of all free parameters at `model`, with its
// noise levels and decay. One matrix a network, outputs x samples of the
// records, in the output's unit; zeros where the model does not tell (no noise
// levels, weights that are fixed).
std::vector<Matrix> NetworkUncertainty(const IdentificationProblem& problem,
                                       const IdentifiedModel& model,
                                       const TrajectorySamples& samples);

}  // namespace pinode

#endif  // PINODE_DISCOVER_NETWORK_UNCERTAINTY_H_
