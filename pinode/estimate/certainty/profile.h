// The profile likelihood of single parameters.

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
  // Names; empty: all that are free.
  std::vector<std::string> parameters;
  // Called as each parameter is done, with all that are; false stops, keeping
  // those that are done.
  std::function<bool(const std::vector<ParameterProfile>& done, int of)>
      callback;
  // Of a run that was cut off: they stand where the fit is within a thousandth
  // of a deviation of where it was.
  std::vector<ParameterProfile> known;
  // Asked after every iteration, by several threads, and may be empty; true
  // stops in the middle of a parameter.
  std::function<bool()> stop;
};

// Along each parameter, from the fit outwards, all others are fitted again (the
// starts of records among them), with the noise as it was found, to where the
// likelihood ratio
//
//   D(c) = 2 (min f | p = c) - min f) / memory
//
// comes to the 95 and 99 % points of chi^2 with one degree of freedom (S. A.
// Murphy and A. W. van der Vaart, J. Am. Stat. Assoc. 95 (2000) 449-465; A.
// Raue and others, Bioinformatics 25 (2009) 1923-1929). `memory` is by how much
// the parameter's variance is larger than the inverse Hessian has it, where
// residuals are autocorrelated (covariance.h): an interval that is linear and
// one by profile agree where the cost is a parabola. Priors are part of f.
//
// `model` and `summary`: of a fit of `problem` with `options`, of which this
// takes the loss and the threads. False, with a sentence, where there is
// nothing to profile: no training record runs, or errors of the excitation were
// unknowns of the fit, whose cost this is not.
[[nodiscard]] bool ProfileParameters(const IdentificationProblem& problem,
                                     const FitSummary& summary,
                                     const IdentifiedModel& model,
                                     const IdentificationOptions& options,
                                     const ProfileOptions& profile_options,
                                     std::vector<ParameterProfile>* profiles,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_PROFILE_H_
