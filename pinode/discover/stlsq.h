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
  // Threshold below which a coefficient leaves the model.
  double threshold = 0.05;
  // Value that is compared with the threshold. True: |Theta_j| |xi_j| / |y|,
  // the share of the output due to the term, free of units. False: |xi_j|, the
  // original method. (Coefficients bound by an equality: all of their columns
  // together, or the largest of them.)
  bool scaled = true;
  // Ridge penalty ridge * sum_j (|Theta_j| xi_j)^2 while thresholding; not used
  // in the last fit.
  double ridge = 0.0;
  int max_num_iterations = 100;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

struct StlsqSolution {
  double threshold = 0.0;
  // Coefficients of all candidates, in their own units; 0 outside support and
  // given ones.
  Vector coefficients;
  // Remaining coefficients, without given ones.
  std::vector<int> support;
  // Sum of squares |y - Theta xi|^2, residuals in units of sigma.
  double sum_of_squares = 0.0;
  // True if the support settled within max_num_iterations.
  bool converged = false;
  int num_iterations = 0;
};

// Fits all candidates, drops those below the threshold, fits the rest, until
// none is dropped (S. L. Brunton, J. L. Proctor, J. N. Kutz, PNAS 113 (2016)
// 3932). Constraints hold in each fit. Returns false for an invalid problem or
// option.
[[nodiscard]] bool SolveStlsq(const RegressionProblem& problem,
                              const StlsqOptions& options,
                              StlsqSolution* solution, std::string* error);

// Computes one solution per threshold, each from all candidates again. No
// `thresholds`: 40 in equal ratios from 1 to 1e-4, which suit scaled ones.
[[nodiscard]] bool SolveStlsqPath(const RegressionProblem& problem,
                                  const StlsqOptions& options,
                                  const std::vector<double>& thresholds,
                                  std::vector<StlsqSolution>* path,
                                  std::string* error);

// Solves the same for a condensed problem; the options must be valid.
StlsqSolution SolveStlsq(const LeastSquaresSystem& system,
                         const CoefficientMap& map,
                         const StlsqOptions& options);

}  // namespace pinode

#endif  // PINODE_DISCOVER_STLSQ_H_
