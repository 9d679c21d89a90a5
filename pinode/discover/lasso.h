// The LASSO's regularisation path.

#ifndef PINODE_DISCOVER_LASSO_H_
#define PINODE_DISCOVER_LASSO_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/coefficient_map.h"
#include "pinode/discover/least_squares_system.h"
#include "pinode/discover/regression_problem.h"

namespace pinode {

struct LassoOptions {
  // Lambdas of the path, descending and positive. Empty: num_lambdas of them in
  // equal ratios from lambda_max, where the first coefficient enters, down to
  // smallest_ratio * lambda_max.
  std::vector<double> lambdas;
  int num_lambdas = 50;
  double smallest_ratio = 1e-4;

  // Penalty of each coefficient (positive, given ones ignored): lambda w_j
  // |xi_j|. Empty: its column's Euclidean norm, in units of the output's sigma.
  // The result then depends neither on the candidates' units nor on the
  // output's. Ones: the original LASSO.
  Vector penalty_weights;

  // Largest number of free coefficients: the path ends after the first solution
  // with more. 0: no limit.
  int max_support = 0;

  // True: the solution of Levenberg-Marquardt, which finds support and signs,
  // is replaced by that of the linear system that these imply, see
  // active_set.h. Without it, the two members below determine the accuracy.
  bool polish = true;
  // Limits of Levenberg-Marquardt at each lambda: iterations, and relative
  // change of the cost.
  int max_num_iterations = 200;
  double function_tolerance = 1e-6;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(int num_coefficients, std::string* error) const;
};

// Solution at one lambda.
struct LassoSolution {
  double lambda = 0.0;
  // Objective 1/2 |y - Theta xi|^2 + lambda sum_j w_j |xi_j|, without the
  // penalty of given coefficients; residuals in units of sigma.
  double objective = 0.0;
  // Upper bound of the objective's distance from its minimum. It is the
  // difference to a feasible point of the dual problem: the residual scaled
  // back until |Theta_j' r| <= lambda w_j for all j (Kim, Koh, Lustig, Boyd,
  // Gorinevsky 2007).
  double duality_gap = 0.0;
  // Coefficients of all candidates, in their own units; exactly 0 outside the
  // support and the given ones.
  Vector coefficients;
  // Coefficients, not given, that the optimality conditions allow to differ
  // from zero: Theta_j'r = lambda w_j sign(xi_j).
  std::vector<int> support;
  // True if the optimality conditions hold.
  bool converged = false;
  // Numbers of Levenberg-Marquardt iterations, and of linear systems solved by
  // the polish.
  int num_iterations = 0;
  int num_faces = 0;
};

struct LassoPath {
  // Smallest lambda at which no coefficient but the given ones is in the model.
  double lambda_max = 0.0;
  std::vector<LassoSolution> solutions;  // by descending lambda
};

// Solves
//
//   min  1/2 |y - Theta xi|^2 + lambda sum_j w_j |xi_j|
//
// (R. Tibshirani, "Regression shrinkage and selection via the lasso", JRSS B 58
// (1996) 267) under the problem's constraints, for each lambda, beginning at
// the previous solution.
//
// With xi = p q (elementwise) the problem is smooth,
//
//   min  1/2 |y - Theta (p q)|^2 + lambda/2 sum_j w_j (p_j^2 + q_j^2),
//
// has the same minimum, and no other local minimum (P. D. Hoff, "Lasso,
// fractional norm and structured sparse estimation using a Hadamard product
// parametrization", Computational Statistics and Data Analysis 115 (2017) 186):
// Ceres solves it by Levenberg-Marquardt, in columns of length 1. A coefficient
// that must not change its sign is p^2 or -p^2. p_j = q_j = 0 is always
// stationary. At every lambda the coefficients that violate their optimality
// condition |Theta_j' r| <= lambda w_j are started again. The support is
// decided by the same conditions, not by a threshold on |xi|.
//
// Returns false for an invalid problem or option. A solution that does not meet
// its optimality conditions has `converged == false`; duality_gap bounds its
// error. If no candidate explains y there is a single solution without
// coefficients, at lambda = 0.
[[nodiscard]] bool SolveLassoPath(const RegressionProblem& problem,
                                  const LassoOptions& options, LassoPath* path,
                                  std::string* error);

// Solves the same for a condensed problem; the options must be valid.
LassoPath SolveLassoPath(const LeastSquaresSystem& system,
                         const CoefficientMap& map,
                         const LassoOptions& options);

}  // namespace pinode

#endif  // PINODE_DISCOVER_LASSO_H_
