// Sequentially thresholded least squares.

#ifndef PINODE_DISCOVER_STLSQ_H_
#define PINODE_DISCOVER_STLSQ_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/coefficient_map.h"
#include "pinode/discover/least_squares_system.h"
#include "pinode/discover/regression_problem.h"

namespace pinode {

struct StlsqOptions {
  // A coefficient below it leaves the model.
  double threshold = 0.05;
  // What is compared with the threshold: |Theta_j| |xi_j| / |y|, the share of
  // the output that the term accounts for, whatever the units; or |xi_j| as it
  // stands, the original method. (Coefficients bound by an equality: all of
  // their columns together, or the largest of them.)
  bool scaled = true;
  // Ridge penalty ridge * sum_j (|Theta_j| xi_j)^2 while thresholding; the last
  // fit is without.
  double ridge = 0.0;
  int max_num_iterations = 100;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

struct StlsqSolution {
  double threshold = 0.0;
  // Of all candidates, in their own units; 0 outside support and given ones.
  Vector coefficients;
  // The coefficients, not given, that are left.
  std::vector<int> support;
  // |y - Theta xi|^2, residuals in units of sigma.
  double sum_of_squares = 0.0;
  // The support stayed the same within max_num_iterations.
  bool converged = false;
  int num_iterations = 0;
};

// Fits all candidates, drops those below the threshold, fits the rest, until
// none is dropped (S. L. Brunton, J. L. Proctor, J. N. Kutz, PNAS 113 (2016)
// 3932). Constraints hold in each fit. False for an invalid problem or option.
[[nodiscard]] bool SolveStlsq(const RegressionProblem& problem,
                              const StlsqOptions& options,
                              StlsqSolution* solution, std::string* error);

// One solution a threshold, each from all candidates anew. No `thresholds`: 40
// in equal ratios from 1 to 1e-4, which suit scaled ones.
[[nodiscard]] bool SolveStlsqPath(const RegressionProblem& problem,
                                  const StlsqOptions& options,
                                  const std::vector<double>& thresholds,
                                  std::vector<StlsqSolution>* path,
                                  std::string* error);

// The same for a condensed problem; the options must be valid.
StlsqSolution SolveStlsq(const LeastSquaresSystem& system,
                         const CoefficientMap& map,
                         const StlsqOptions& options);

}  // namespace pinode

#endif  // PINODE_DISCOVER_STLSQ_H_
