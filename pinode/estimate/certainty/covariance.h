// Covariance of the identified parameters.

#ifndef PINODE_ESTIMATE_CERTAINTY_COVARIANCE_H_
#define PINODE_ESTIMATE_CERTAINTY_COVARIANCE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/problem/identification_options.h"

namespace pinode {

struct CovarianceEstimate {
  // Covariance of all free parameters, num_free x num_free.
  Matrix covariance;
  // Method: "plain", "sandwich", "inflated" or "input noise"; "errors in
  // variables" from FitWithInputNoise.
  std::string method;
  // Half-width of the 95 % interval in standard deviations.
  double quantile = 1.96;
  // Unit vectors (scaled by each parameter's own curvature) along which the
  // cost does not change within rounding: num_free x count.
  Matrix null_space;
};

// Estimates the covariance at the solution `free` of `objective`, which is
// linearised there.
//
//   plain         H^-1, H the Gauss-Newton Hessian with priors and decay
//   sandwich      H^-1 (sum_b g_b g_b' + P) H^-1 over blocks of consecutive
//                 samples, g_b the score of a block and P the priors' precision
//                 (H. R. Kuensch, Ann. Statist. 17 (1989) 1217-1241): for
//                 residuals that are autocorrelated
//   input noise   H^-1 (sum_c rho_c J_c' J_c + sum_i sigma_i^2 v_i v_i' + P)
//                 H^-1, v_i the effect of one input sample on the score by an
//                 adjoint run; rho_c the share of output noise in channel c's
//                 residual
//   inflated      H^-1 (sum_c tau_c J_c' J_c + P) H^-1, tau_c the
//                 autocorrelation time of channel c's residuals in samples: in
//                 place of the sandwich where an unknown force has more knots
//                 than there are blocks
//
// If the spectra of ambient records differ from the model's, or the residuals
// of FRFs are not noise, the middle of all but the plain method has the
// products of the scores of their lines in place of their information. kAuto
// takes input noise if a training record has a noisy input. It takes sandwich
// or inflated if a Ljung-Box test finds autocorrelation, else plain (or a
// sandwich of lines alone). The test uses residuals at a draw from the
// posterior. These are white if the noise is white, however much of the noise
// the fit has followed. Returns false if the Hessian is not finite.
[[nodiscard]] bool EstimateCovariance(const IdentificationProblem& problem,
                                      const ParameterLayout& layout,
                                      IdentificationOptions::Covariance choice,
                                      const Vector& free,
                                      const std::vector<Vector>& sigmas,
                                      Objective* objective,
                                      CovarianceEstimate* estimate);

// Returns the relative size below which a problem's information counts as
// rounding error. The information of ambient records is a difference of sums
// over many lines.
double InformationRounding(const IdentificationProblem& problem);

// Inverts an information matrix (n x n, symmetric). *inverse_root is R, n x n,
// with the covariance R R'. The columns of *null_space are unit vectors (scaled
// by each parameter's own information) without information: within `rounding`
// of the largest and for each of the n. R gives them a very large variance.
// Returns false if the matrix is not finite.
[[nodiscard]] bool InvertInformation(const Matrix& information,
                                     Matrix* inverse_root, Matrix* null_space,
                                     double rounding = 1e-13);

// Finds L with H + e I = L L' for the least e of 1e-10, 1e-9, ..., 1 that makes
// it positive definite. H (n x n, symmetric) is an information matrix scaled to
// a unit diagonal. Rounding in starts of diverging trajectories can make H
// indefinite. Directions below e are not determined, and L^-1 gives them a
// large variance. Returns false, with *lower untouched, if H is not finite or
// no such e is enough.
[[nodiscard]] bool FactorizeInformation(const Matrix& information,
                                        Matrix* lower);

// Returns H^-1 g by FactorizeInformation of H (n x n, symmetric, any units),
// scaled to a unit diagonal. Empty if there is no factor.
Vector SolveInformation(const Matrix& information, const Vector& right);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_COVARIANCE_H_
