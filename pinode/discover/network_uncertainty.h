// Uncertainty of a network's outputs as determined by the records.

#ifndef PINODE_DISCOVER_NETWORK_UNCERTAINTY_H_
#define PINODE_DISCOVER_NETWORK_UNCERTAINTY_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/trajectory_samples.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Returns the standard deviation of the outputs y of each network of `problem`
// along `samples`, from the posterior covariance of the weights w,
//
//   sigma_y^2 = (dy/dw) H^-1 (dy/dw)',
//
// where H is the Gauss-Newton Hessian of all free parameters at `model`, with
// its noise levels and decay. One matrix per network, outputs x samples of the
// records, in the output's unit. Zeros if the model does not determine it (no
// noise levels, fixed weights).
std::vector<Matrix> NetworkUncertainty(const IdentificationProblem& problem,
                                       const IdentifiedModel& model,
                                       const TrajectorySamples& samples);

}  // namespace pinode

#endif  // PINODE_DISCOVER_NETWORK_UNCERTAINTY_H_
