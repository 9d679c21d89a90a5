// Fits from several starts, of which the best is kept.

#ifndef PINODE_ESTIMATE_FIT_MULTISTART_H_
#define PINODE_ESTIMATE_FIT_MULTISTART_H_

#include <cstdint>
#include <memory>

#include "pinode/base/types.h"
#include "pinode/estimate/fit/fit.h"

namespace pinode {

// Returns values of all parameters to start from. Free named ones are drawn
// between their bounds and within their priors (if both ends are finite).
// Networks get other seeds.
Vector DrawStart(const IdentificationProblem& problem,
                 const ParameterLayout& layout, const MultistartTuning& tuning,
                 uint64_t seed);

// Most starts of a linear structure's fit that ends lost: it breaks down, or
// predicts hardly better than no motion would.
inline constexpr int kStartsOfLost = 4;

// Runs a fit from `initial` (nullptr: from the problem's own values, with
// pulses from the scan), then from drawn starts. Returns the fit with the
// smallest expected error or, with modes alone, the smallest cost. *summary is
// that of the best fit, and counts the starts that reached the same cost.
// Returns nullptr, with a message in *summary, if no start finished.
std::unique_ptr<Fit> RunStarts(const IdentificationProblem& problem,
                               const IdentificationOptions& options,
                               const IdentifiedModel* initial,
                               FitSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_MULTISTART_H_
