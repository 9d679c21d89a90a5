// Fits in which the excitation is unknown within its noise.

#ifndef PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_FIT_H_
#define PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_FIT_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// What a fit has found, and what the one below makes of it.
struct InputNoiseFit {
  Vector free;
  std::vector<Vector> sigmas;        // of the sensors, per training record
  std::vector<Matrix> trajectories;  // num_states x samples, likewise
  std::vector<Matrix> starts;        // num_states x 1, likewise
  double cost = 0.0;
  CovarianceEstimate covariance;
};

using InputNoiseCallback = std::function<bool(const Vector& free, double cost)>;

// Whether FitWithInputNoise is for this problem: a training record has a noisy
// input, all their inputs are held or linear between samples, no filter is in
// the way, and the loss is the plain one.
bool CanFitWithInputNoise(const IdentificationProblem& problem,
                          RobustLoss loss);

// Errors in variables. Least squares takes the measured excitation for the true
// one; its noise then is in the residuals, filtered to the structure's
// frequencies, and with it in the parameters. Here the errors e of the
// excitation's samples are unknowns beside the parameters and the starts, with
// their known deviation sigma_u:
//
//   min over theta, s, e of
//     1/2 sum (y - yhat(theta, s, u + e))^2 / sigma^2 + 1/2 sum e^2 / sigma_u^2
//     + priors
//
// (W. A. Fuller, Measurement Error Models, Wiley, 1987), by Gauss-Newton from
// the least-squares fit in *fit. Errors and starts are eliminated by a Kalman
// filter along each record's trajectory, so that the cost is linear in its
// length. The deviations sigma of the sensors that are not given are estimated
// by expectation maximisation. The covariance is the inverse of the information
// that is left to theta.
//
// `go_on` is told parameters and cost after each iteration and ends the fit by
// returning false. False, with *fit as it was, where it does so or the
// iteration does not converge; *error then says why.
[[nodiscard]] bool FitWithInputNoise(const IdentificationProblem& problem,
                                     const ParameterLayout& layout,
                                     const MultipleShooting::Options& options,
                                     const Vector& decays,
                                     const InputNoiseCallback& go_on,
                                     InputNoiseFit* fit, std::string* error);

// The covariance that the fit above would have if it ended at *fit's parameters
// and noise levels, into fit->covariance. False where the trajectory is not
// finite.
[[nodiscard]] bool InputNoiseCovariance(
    const IdentificationProblem& problem, const ParameterLayout& layout,
    const MultipleShooting::Options& options, const Vector& decays,
    InputNoiseFit* fit);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_FIT_H_
