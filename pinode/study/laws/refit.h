// Refit of discovered equations, in place of networks, to the trajectories.

#ifndef PINODE_STUDY_LAWS_REFIT_H_
#define PINODE_STUDY_LAWS_REFIT_H_

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/problem/identification_watch.h"

namespace pinode {

// Result of discovery.
struct Discovery {
  // Equations as selected by the regression, or after the refit.
  std::vector<DiscoveredEquation> equations;
  // Terms that the refit has dropped and added, such as "x1: x[x2]^2".
  std::vector<std::string> dropped;
  std::vector<std::string> added;

  // Other sets of terms that describe the records about as well, most likely
  // first. Empty without a search.
  std::vector<TermRival> rivals;

  // True if there was a refit. If not, problem, summary, model and
  // step_refinement have no meaning.
  bool refitted = false;
  IdentificationProblem problem;  // with the equations as terms
  IdentificationSummary summary;
  IdentifiedModel model;
  // Factor on the chosen number of Runge-Kutta steps per sample.
  int step_refinement = 1;

  // Number of terms of all equations.
  int num_terms() const;
  // Verdict on the equations: the verdict on the refit, if there was one.
  Verdict verdict() const;
  // Returns the first finding, or the state of the refit, in a sentence.
  std::string Message() const;
};

// Replaces the networks of `problem`, trained as `model`, by `equations`. Then
// fits the coefficients, with all other free parameters, to the trajectories.
// In this fit only the noise of the records counts, not the errors of smoothing
// or of a network.
//
// Equations that were regressed on derivatives begin with the terms that
// ProposeFromSegments chooses, if these explain the records better.
//
// 1. Terms that are not worth their price are dropped one by one
//    (DiscoveryOptions::prune_fraction).
// 2. Candidates that the residuals require are added as long as they lower the
//    extended BIC (J. Chen and Z. Chen 2008; DiscoveryOptions::search). The
//    search begins without terms if the terms together are not worth their
//    price or cannot be fitted.
// 3. The terms are compared with other sets of terms. A better set takes their
//    place. Each term gets its probability among these sets, and a term below
//    kCertainTerm is a finding (DiscoveryOptions::search).
// 4. The Runge-Kutta steps are halved, at most five times, until no coefficient
//    changes by more than a tenth of its standard deviation or 1e-8 of itself.
//    An equation then does not compensate for errors of integration.
//
// The last fit is made by Identify. `identification` are the options of each
// fit. `watch` observes each fit and may be nullptr. `resumed` has the
// equations with which an interrupted refit continues; nullptr: a new refit.
//
// Returns false, with *error, if equations or model do not match the problem,
// or if no unknown is left. If a fit fails, the function returns true, and
// discovery->summary describes the failure.
[[nodiscard]] bool RefitEquations(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    const std::vector<DiscoveredEquation>& equations,
    const DiscoveryOptions& options,
    const IdentificationOptions& identification,
    const std::vector<DiscoveredEquation>* resumed, IdentificationWatch* watch,
    Discovery* discovery, std::string* error);

// Returns the equations as selected, without a refit. Coefficients get units if
// the equations belong to `problem`.
Discovery WithoutRefit(const IdentificationProblem& problem,
                       const std::vector<DiscoveredEquation>& equations);

}  // namespace pinode

#endif  // PINODE_STUDY_LAWS_REFIT_H_
