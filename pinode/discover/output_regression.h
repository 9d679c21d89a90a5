// One output of one network as a sum of candidates.

#ifndef PINODE_DISCOVER_OUTPUT_REGRESSION_H_
#define PINODE_DISCOVER_OUTPUT_REGRESSION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/discovery.h"

namespace pinode {

// Regresses `y` (one value per sample, in the output's unit) on candidates made
// of `features` (samples x features, as equation->feature_names),
//
//   y = Theta(q) xi   (Lai et al. (2021), eq. (7)),
//
// and takes the fewest terms with
//
//   sqrt((SSR - SSR_min) / samples) <= tolerance * scale,
//
// where SSR_min is that of all candidates together. The tolerance is that of
// the options, or the equation's uncertainty if that is larger (at most one
// half). Supports are proposed by the solver's path and by elimination from it
// (SelectSupport). Coefficients are those of FitRobustly.
//
// On entry `equation` has names, scale and uncertainty. The function adds
// regressed values, candidates, Pareto curve and terms. record_starts: first
// sample of each record. without_slope: leaves out candidates that are plain
// features (see DiscoverFromNetworks). Returns false for a candidate that
// cannot be evaluated, if no candidate is left, or for constraints on unknown
// candidates; *error names the network and the output.
[[nodiscard]] bool RegressOutput(const DiscoveryOptions& options,
                                 const Matrix& features,
                                 const std::vector<Eigen::Index>& record_starts,
                                 const Vector& y, bool without_slope,
                                 DiscoveredEquation* equation,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_OUTPUT_REGRESSION_H_
