// Several starts, of which the best stands.

#ifndef PINODE_ESTIMATE_FIT_MULTISTART_H_
#define PINODE_ESTIMATE_FIT_MULTISTART_H_

#include <cstdint>
#include <memory>

#include "pinode/base/types.h"
#include "pinode/estimate/fit/fit.h"

namespace pinode {

// Values of all parameters to start from: free named ones drawn between their
// bounds and within their priors (where both ends are finite), networks with
// other seeds.
Vector DrawStart(const IdentificationProblem& problem,
                 const ParameterLayout& layout, const MultistartTuning& tuning,
                 uint64_t seed);

// Runs a fit from `initial` (nullptr: from the problem's own values, with
// pulses where the scan finds them), then from starts that are drawn, and
// returns the one with the least error to be expected, or, where there are
// modes alone, the least cost. *summary is that of the best,
// and says how many starts have come to the same cost. nullptr, with a
// message in *summary, where none came to an end.
std::unique_ptr<Fit> RunStarts(const IdentificationProblem& problem,
                               const IdentificationOptions& options,
                               const IdentifiedModel* initial,
                               FitSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_MULTISTART_H_
