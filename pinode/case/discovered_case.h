// Equations in place of networks, and their refit through the ODE.

#ifndef PINODE_CASE_DISCOVERED_CASE_H_
#define PINODE_CASE_DISCOVERED_CASE_H_

#include <string>
#include <vector>

#include "pinode/case/case_file.h"
#include "pinode/discover/discovery.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

struct Discovery {
  // As selected; after a refit, as left by it.
  std::vector<DiscoveredEquation> equations;
  // What the refit took out again, "x1: x[x2]^2", and what it took in.
  std::vector<std::string> dropped;
  std::vector<std::string> added;

  // Of the refit; nothing of it holds without one (`refitted` false).
  bool refitted = false;
  Case discovered;
  IdentificationSummary summary;
  IdentifiedModel model;
  // Runge-Kutta steps a sample of each record are this multiple of what the
  // case chooses.
  int step_refinement = 1;

  int num_terms() const;
};

// The case `c` with libraries in place of the networks that `equations` speak
// of, named <network>_<output>, and the parameters with which a fit begins:
// values, noise and starts of `model`, coefficients of the equations. Steps a
// sample: `substeps` (one a record) where it is not empty. The case's own
// initial values are those of `c`, and 0 for coefficients that are not given:
// the prior model of a fit is the one before discovery, without networks.
[[nodiscard]] bool MakeDiscoveredCase(
    const Case& c, const IdentifiedModel& model,
    const std::vector<DiscoveredEquation>& equations,
    const std::vector<int>& substeps, Case* discovered,
    IdentifiedModel* initial, std::string* error);

// Replaces the networks of `c`, trained as `model`, by `equations` and fits
// their coefficients, with everything else that is free, to the trajectories.
// Terms that turn out not to be worth their place are dropped one by one
// (DiscoveryOptions::prune_fraction); then candidates that the residuals of the
// trajectories ask for are taken in (DiscoveryOptions::search), as long as they
// lower the extended BIC of the fit, beginning with none where the terms
// together are not worth their price or cannot be fitted. Noise on the records
// is noise there, whatever smoothing or a network has made of it. At the end
// the Runge-Kutta steps are halved until no coefficient moves by more than a
// tenth of its standard deviation or 1e-8 of itself, at most five times: an
// equation should not make up for its integrator. c.options hold for each fit.
// `resumed`: the equations with which a refit that was cut off is to go on,
// nullptr for a new one. False where the case cannot be made; a fit that fails
// is a summary that says so.
[[nodiscard]] bool RefitEquations(
    const Case& c, const IdentifiedModel& model,
    const std::vector<DiscoveredEquation>& equations,
    const std::vector<DiscoveredEquation>* resumed, Discovery* discovery,
    std::string* error);

// The equations as selected, without a refit.
Discovery WithoutRefit(const Case& c,
                       const std::vector<DiscoveredEquation>& equations);

}  // namespace pinode

#endif  // PINODE_CASE_DISCOVERED_CASE_H_
