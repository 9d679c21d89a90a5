// Fits in which the excitation is unknown within its noise (errors in
// variables).

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

// State of a fit, before and after FitWithInputNoise.
struct InputNoiseFit {
  Vector free;
  std::vector<Vector> sigmas;        // of the sensors, per training record
  std::vector<Matrix> trajectories;  // num_states x samples, likewise
  std::vector<Matrix> starts;        // num_states x 1, likewise
  double cost = 0.0;
  CovarianceEstimate covariance;
};

using InputNoiseCallback = std::function<bool(const Vector& free, double cost)>;

// True if FitWithInputNoise applies to this problem: a training record has a
// noisy input, all inputs of such records are held or linear between samples,
// there is no filter, and the loss is the plain one.
bool CanFitWithInputNoise(const IdentificationProblem& problem,
                          RobustLoss loss);

// Fits errors in variables. Least squares takes the measured excitation for the
// true one. Its noise then enters the residuals, filtered to the structure's
// frequencies, and with them the parameters. Here the errors e of the
// excitation's samples are unknowns, together with the parameters and the
// starts. Their deviation sigma_u is known:
//
//   min over theta, s, e of
//     1/2 sum (y - yhat(theta, s, u + e))^2 / sigma^2 + 1/2 sum e^2 / sigma_u^2
//     + priors
//
// (W. A. Fuller, Measurement Error Models, Wiley, 1987), by Gauss-Newton from
// the least-squares fit in *fit. Errors and starts are eliminated by a Kalman
// filter along each record's trajectory, so that the work is linear in its
// length. Sensor deviations sigma that are not given are estimated by
// expectation maximisation. The covariance is the inverse of the information
// that remains for theta.
//
// `go_on` is called with parameters and cost after each iteration and ends the
// fit by returning false. Returns false, with *fit unchanged and the reason in
// *error, if `go_on` ends the fit or the iteration does not converge.
[[nodiscard]] bool FitWithInputNoise(const IdentificationProblem& problem,
                                     const ParameterLayout& layout,
                                     const MultipleShooting::Options& options,
                                     const Vector& decays,
                                     const InputNoiseCallback& go_on,
                                     InputNoiseFit* fit, std::string* error);

// Computes the covariance of FitWithInputNoise as if it ended at *fit's
// parameters and noise levels, into fit->covariance. Returns false if the
// trajectory is not finite.
[[nodiscard]] bool InputNoiseCovariance(
    const IdentificationProblem& problem, const ParameterLayout& layout,
    const MultipleShooting::Options& options, const Vector& decays,
    InputNoiseFit* fit);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_INPUT_NOISE_FIT_H_
