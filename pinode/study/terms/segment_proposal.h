// Terms chosen before any fit, from short segments of the records.

#ifndef PINODE_STUDY_TERMS_SEGMENT_PROPOSAL_H_
#define PINODE_STUDY_TERMS_SEGMENT_PROPOSAL_H_

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/discover/term_prices.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Chooses terms for equations that were regressed on smoothed derivatives.
// All candidates together are fitted to the records by multiple shooting, over
// segments of a quarter of a period. Near there the cost is almost quadratic in
// the coefficients, whatever they are, and its noise is that of the records.
// SelectStepwise then chooses at these prices. `model`: what
// DiscoverFromDerivatives gives for `problem`.
//
// *proposed are the equations with the terms chosen. Leaves it empty if nothing
// can be said: the equations have no samples, or the segments are not finite.
// Returns false, with *error, if the candidates do not fit the problem.
[[nodiscard]] bool ProposeFromSegments(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    const std::vector<DiscoveredEquation>& equations,
    const DiscoveryOptions& options, const TermPrices& prices, int num_threads,
    std::vector<DiscoveredEquation>* proposed, std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_SEGMENT_PROPOSAL_H_
