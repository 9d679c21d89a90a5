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
  // The path's lambdas, descending and positive. Empty: num_lambdas of them in
  // equal ratios from lambda_max, where the first coefficient enters, down to
  // smallest_ratio * lambda_max.
  std::vector<double> lambdas;
  int num_lambdas = 50;
  double smallest_ratio = 1e-4;

  // Penalty of each coefficient (positive, given ones ignored): lambda w_j
  // |xi_j|. Empty: its column's Euclidean norm, in units of the output's sigma,
  // so that neither the candidates' units nor those of the output matter. Ones:
  // the LASSO as it stands.
  Vector penalty_weights;

  // The path ends behind the first solution with more free coefficients; 0:
  // never.
  int max_support = 0;

  // Whether the solution of Levenberg-Marquardt, which finds support and signs,
  // is replaced by that of the linear system that these imply, see
  // active_set.h. Without, what accuracy there is comes from the two members
  // below.
  bool polish = true;
  // Of Levenberg-Marquardt at each lambda; relative change of the cost.
  int max_num_iterations = 200;
  double function_tolerance = 1e-6;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(int num_coefficients, std::string* error) const;
};

// The solution at one lambda.
struct LassoSolution {
  double lambda = 0.0;
  // 1/2 |y - Theta xi|^2 + lambda sum_j w_j |xi_j|, without the penalty of
  // given coefficients; residuals in units of sigma.
  double objective = 0.0;
  // The objective is at most this much above its minimum: the difference to a
  // feasible point of the dual problem, which is the residual scaled back until
  // |Theta_j' r| <= lambda w_j everywhere (Kim, Koh, Lustig, Boyd, Gorinevsky
  // 2007).
  double duality_gap = 0.0;
  // Of all candidates, in their own units; exactly 0 outside the support and
  // the given ones.
  Vector coefficients;
  // The coefficients, not given, that the optimality conditions allow to differ
  // from zero: Theta_j'r = lambda w_j sign(xi_j).
  std::vector<int> support;
  // The optimality conditions hold.
  bool converged = false;
  // Levenberg-Marquardt iterations, and linear systems solved by the polish.
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
// the solution before.
//
// With xi = p q (elementwise) the problem is smooth,
//
//   min  1/2 |y - Theta (p q)|^2 + lambda/2 sum_j w_j (p_j^2 + q_j^2),
//
// has the same minimum, and no local minimum besides (P. D. Hoff, "Lasso,
// fractional norm and structured sparse estimation using a Hadamard product
// parametrization", Computational Statistics and Data Analysis 115 (2017) 186):
// Ceres solves it by Levenberg-Marquardt, in columns of length 1. A coefficient
// that must not change its sign is p^2 or -p^2. p_j = q_j = 0 is always
// stationary; at every lambda those coefficients whose optimality condition
// |Theta_j' r| <= lambda w_j is violated start anew. The support is decided by
// the same conditions, not by a threshold on |xi|.
//
// False for an invalid problem or option. A solution that does not meet its
// optimality conditions has `converged == false`; duality_gap says what that is
// worth. If nothing explains y there is a single solution without coefficients,
// at lambda = 0.
[[nodiscard]] bool SolveLassoPath(const RegressionProblem& problem,
                                  const LassoOptions& options, LassoPath* path,
                                  std::string* error);

// The same for a condensed problem; the options must be valid.
LassoPath SolveLassoPath(const LeastSquaresSystem& system,
                         const CoefficientMap& map,
                         const LassoOptions& options);

}  // namespace pinode

#endif  // PINODE_DISCOVER_LASSO_H_
