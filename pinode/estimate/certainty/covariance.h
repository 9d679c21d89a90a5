// How sure the identified parameters are.

#ifndef PINODE_ESTIMATE_CERTAINTY_COVARIANCE_H_
#define PINODE_ESTIMATE_CERTAINTY_COVARIANCE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/problem/identification_options.h"

namespace pinode {

struct CovarianceEstimate {
  // Of all free parameters, num_free x num_free.
  Matrix covariance;
  // "plain", "sandwich", "inflated", "input noise"; from FitWithInputNoise
  // "errors in variables".
  std::string method;
  // Half-width of the 95 % interval in standard deviations.
  double quantile = 1.96;
  // Unit vectors (scaled by each parameter's own curvature) along which the
  // cost does not change within rounding: num_free x count.
  Matrix null_space;
};

// At the solution `free` of `objective`, which is linearised there.
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
// In each but the first, ambient records have the products of the scores of
// their lines in the middle, in place of their information, where their spectra
// are not those of the model. kAuto takes input noise where a training record
// has a noisy input, sandwich or inflated where a Ljung-Box test finds
// autocorrelation, else plain (or a sandwich of ambient records alone). The
// test is of residuals at a draw from the posterior, which are white where the
// noise is, however much of it the fit has followed. Returns false where the
// Hessian is not finite.
[[nodiscard]] bool EstimateCovariance(const IdentificationProblem& problem,
                                      const ParameterLayout& layout,
                                      IdentificationOptions::Covariance choice,
                                      const Vector& free,
                                      const std::vector<Vector>& sigmas,
                                      Objective* objective,
                                      CovarianceEstimate* estimate);

// What is nothing of a problem's information beside its largest: that of
// ambient records is a difference of sums over many lines.
double InformationRounding(const IdentificationProblem& problem);

// A root R of the inverse of an information matrix (n x n, symmetric), so that
// R R' is the covariance, n x n, and the unit vectors (scaled by each
// parameter's own information) along which there is none within `rounding` of
// the largest and for each of the n, which R gives a very large variance. False
// where the matrix is not finite.
[[nodiscard]] bool InvertInformation(const Matrix& information,
                                     Matrix* inverse_root, Matrix* null_space,
                                     double rounding = 1e-13);

// L of H + e I = L L' with the least e of 1e-10, 1e-9, ..., 1 that makes it
// positive definite; H (n x n, symmetric) is an information matrix scaled to a
// unit diagonal. Starts of trajectories that diverge leave rounding behind
// which can make H indefinite; along directions below e nothing is determined,
// and L^-1 gives them a large variance. False, with *lower untouched, where H
// is not finite or no such e is enough.
[[nodiscard]] bool FactorizeInformation(const Matrix& information,
                                        Matrix* lower);

// H^-1 g by FactorizeInformation of H (n x n, symmetric, any units), scaled to
// a unit diagonal; empty where there is none.
Vector SolveInformation(const Matrix& information, const Vector& right);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_COVARIANCE_H_
