// A regression condensed for least squares.

#ifndef PINODE_DISCOVER_LEAST_SQUARES_SYSTEM_H_
#define PINODE_DISCOVER_LEAST_SQUARES_SYSTEM_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/coefficient_map.h"
#include "pinode/discover/regression_problem.h"

namespace pinode {

// Residuals of a regression in its free unknowns g, transformed by QR into
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
  // Number of residuals: samples times outputs.
  Eigen::Index num_residuals = 0;

  int num_free() const { return static_cast<int>(A.cols()); }
  double SumOfSquares(const Vector& free) const {
    return (b - A * free).squaredNorm() + rest;
  }
};

// Condenses the samples of `block`. The problem must be valid and `map` its
// own.
LeastSquaresSystem Condense(const RegressionProblem& problem,
                            const CoefficientMap& map, const TimeBlock& block);
// Condenses all samples.
LeastSquaresSystem Condense(const RegressionProblem& problem,
                            const CoefficientMap& map);

// Combines the systems, with systems[i] counted multiplicities[i] times (0:
// left out). At least one must count.
LeastSquaresSystem Combine(const std::vector<LeastSquaresSystem>& systems,
                           const std::vector<int>& multiplicities);

// Returns the least-squares solution on the unknowns in `support`, the others
// being 0, under the map's signs (Lawson and Hanson, "Solving Least Squares
// Problems", 1974, chapter 23). If columns depend on each other, the split
// between their unknowns is arbitrary. ridge: adds ridge * sum_i (|A_i| g_i)^2.
Vector FitSupport(const LeastSquaresSystem& system, const CoefficientMap& map,
                  const std::vector<int>& support, double ridge = 0.0);

}  // namespace pinode

#endif  // PINODE_DISCOVER_LEAST_SQUARES_SYSTEM_H_
