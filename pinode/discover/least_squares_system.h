// A regression reduced to what least squares needs of it.

#ifndef PINODE_DISCOVER_LEAST_SQUARES_SYSTEM_H_
#define PINODE_DISCOVER_LEAST_SQUARES_SYSTEM_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/coefficient_map.h"
#include "pinode/discover/regression_problem.h"

namespace pinode {

// The residuals of a regression in its free unknowns g, turned by orthogonal
// transformations (QR) into
//
//   |y - Theta xi(g)|^2 = |b - A g|^2 + rest     (residuals in units of sigma)
//
// with at most as many rows as unknowns, so that no solver's cost depends on
// the number of samples. Exact up to rounding; unlike Theta'Theta, A is no
// worse conditioned than Theta.
struct LeastSquaresSystem {
  Matrix A;  // rows x free unknowns, rows <= free unknowns
  Vector b;
  double rest = 0.0;
  // Samples times outputs behind it.
  Eigen::Index num_residuals = 0;

  int num_free() const { return static_cast<int>(A.cols()); }
  double SumOfSquares(const Vector& free) const {
    return (b - A * free).squaredNorm() + rest;
  }
};

// The samples of `block`; the problem must be valid and `map` its own.
LeastSquaresSystem Condense(const RegressionProblem& problem,
                            const CoefficientMap& map, const TimeBlock& block);
// All samples.
LeastSquaresSystem Condense(const RegressionProblem& problem,
                            const CoefficientMap& map);

// The systems together, systems[i] counted multiplicities[i] times (0: left
// out). At least one must count.
LeastSquaresSystem Combine(const std::vector<LeastSquaresSystem>& systems,
                           const std::vector<int>& multiplicities);

// The least-squares solution on the unknowns in `support`, the others being 0,
// under the map's signs (Lawson and Hanson, "Solving Least Squares Problems",
// 1974, chapter 23). Unknowns whose columns depend on each other share their
// part in no particular way. ridge: adds ridge * sum_i (|A_i| g_i)^2.
Vector FitSupport(const LeastSquaresSystem& system, const CoefficientMap& map,
                  const std::vector<int>& support, double ridge = 0.0);

}  // namespace pinode

#endif  // PINODE_DISCOVER_LEAST_SQUARES_SYSTEM_H_
