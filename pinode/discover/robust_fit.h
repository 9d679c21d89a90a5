// Robust coefficients, insensitive to a few bad samples.

#ifndef PINODE_DISCOVER_ROBUST_FIT_H_
#define PINODE_DISCOVER_ROBUST_FIT_H_

#include "pinode/base/types.h"
#include "pinode/discover/coefficient_map.h"
#include "pinode/discover/regression_problem.h"
#include "pinode/discover/selection.h"

namespace pinode {

// Returns the coefficients of the terms in entry.support by Huber's M-estimator
// (P. J. Huber, Annals of Mathematical Statistics 35 (1964) 73),
//
//   min sum_i rho(r_i),  r = y - Theta xi,
//   rho(r) = r^2 / 2 for |r| <= c, else c |r| - c^2 / 2,
//
// by reweighted least squares from entry.coefficients, with c = 1.345 robust
// standard deviations of the residuals (1.4826 times their median), under the
// conditions of `map`. A network is most wrong where the trajectories pass
// once, at their largest displacements. Least squares would follow it most
// closely there. `problem`: of one output, valid, `map` its own.
Vector FitRobustly(const RegressionProblem& problem, const CoefficientMap& map,
                   const SelectionEntry& entry);

}  // namespace pinode

#endif  // PINODE_DISCOVER_ROBUST_FIT_H_
