// Profile likelihood of single parameters.

#ifndef PINODE_ESTIMATE_CERTAINTY_PROFILE_H_
#define PINODE_ESTIMATE_CERTAINTY_PROFILE_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/parameter_profile.h"

namespace pinode {

struct ProfileOptions {
  // Names of the parameters; empty: all free ones.
  std::vector<std::string> parameters;
  // Called when a parameter is done, with all finished profiles. Returning
  // false stops and keeps the finished profiles.
  std::function<bool(const std::vector<ParameterProfile>& done, int of)>
      callback;
  // Profiles of an interrupted run. They remain valid if the fit is within a
  // thousandth of a deviation of its former value.
  std::vector<ParameterProfile> known;
  // Called after every iteration, by several threads; may be empty. Returning
  // true stops in the middle of a parameter.
  std::function<bool()> stop;
};

// Computes the profile of each parameter, from the fit outwards. All other
// parameters, including the starts of records, are fitted again, with the noise
// of the fit. Each profile ends where the likelihood ratio
//
//   D(c) = 2 (min f | p = c) - min f) / memory
//
// reaches the 95 and 99 % points of chi^2 with one degree of freedom (S. A.
// Murphy and A. W. van der Vaart, J. Am. Stat. Assoc. 95 (2000) 449-465; A.
// Raue and others, Bioinformatics 25 (2009) 1923-1929). `memory` is the ratio
// of the parameter's variance to that of the inverse Hessian if residuals are
// autocorrelated (covariance.h). Linear and profile intervals then agree where
// the cost is a parabola. Priors are part of f.
//
// `model` and `summary`: of a fit of `problem` with `options`, from which this
// function takes the loss and the threads. Returns false, with a sentence in
// *error, if there is nothing to profile: no training record runs, or errors of
// the excitation were unknowns of the fit, which has a different cost.
[[nodiscard]] bool ProfileParameters(const IdentificationProblem& problem,
                                     const FitSummary& summary,
                                     const IdentifiedModel& model,
                                     const IdentificationOptions& options,
                                     const ProfileOptions& profile_options,
                                     std::vector<ParameterProfile>* profiles,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_PROFILE_H_
