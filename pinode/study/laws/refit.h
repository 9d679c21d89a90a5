// Discovered equations in place of networks, refitted through the ODE.

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

struct Discovery {
  // Equations as selected, or as the refit left them.
  std::vector<DiscoveredEquation> equations;
  // Terms that the refit took out again, "x1: x[x2]^2", and terms that it took
  // in.
  std::vector<std::string> dropped;
  std::vector<std::string> added;

  // The refit by the main job. Without one (`refitted` false) problem, summary,
  // model and step_refinement hold nothing.
  bool refitted = false;
  IdentificationProblem problem;  // with the equations
  IdentificationSummary summary;
  IdentifiedModel model;
  // Runge-Kutta steps a sample of each record are this multiple of what the
  // problem chooses.
  int step_refinement = 1;

  int num_terms() const;
  // Verdict on the equations: that of the refit, if there was one.
  Verdict verdict() const;
  // The first finding, or the state of the refit, in a sentence.
  std::string Message() const;
};

// Replaces the networks of `problem`, trained as `model`, by `equations` and
// fits their coefficients, with everything else that is free, to the
// trajectories. Terms that turn out not to be worth their place are dropped one
// by one (DiscoveryOptions::prune_fraction); then candidates that the residuals
// of the trajectories ask for are taken in (DiscoveryOptions::search), as long
// as they lower the extended BIC of the fit, beginning with none where the
// terms together are not worth their price or cannot be fitted. Noise on the
// records is noise there, whatever smoothing or a network has made of it. At
// the end the Runge-Kutta steps are halved until no coefficient moves by more
// than a tenth of its standard deviation or 1e-8 of itself, at most five times:
// an equation should not make up for its integrator. The last fit is that of
// Identify. `identification` holds for each fit; `watch` (may be nullptr) hears
// of each. `resumed`: the equations with which an interrupted refit goes on,
// nullptr for a new one.
//
// False, with *error, where equations or model do not fit the problem, or
// nothing is left to be found; a fit that fails is a summary that says so.
[[nodiscard]] bool RefitEquations(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    const std::vector<DiscoveredEquation>& equations,
    const DiscoveryOptions& options,
    const IdentificationOptions& identification,
    const std::vector<DiscoveredEquation>* resumed, IdentificationWatch* watch,
    Discovery* discovery, std::string* error);

// The equations as selected, without a refit; with units where they are of
// `problem`.
Discovery WithoutRefit(const IdentificationProblem& problem,
                       const std::vector<DiscoveredEquation>& equations);

}  // namespace pinode

#endif  // PINODE_STUDY_LAWS_REFIT_H_
