// One output of one network as a sum of candidates.

#ifndef PINODE_DISCOVER_OUTPUT_REGRESSION_H_
#define PINODE_DISCOVER_OUTPUT_REGRESSION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/discovery.h"

namespace pinode {

// Regresses `y` (one value a sample, in the output's unit) on candidates made
// of `features` (samples x features, as equation->feature_names),
//
//   y = Theta(q) xi   (Lai et al. (2021), eq. (7)),
//
// and takes the fewest terms with
//
//   sqrt((SSR - SSR_min) / samples) <= tolerance * scale,
//
// SSR_min being that of all candidates together, and the tolerance that of the
// options or the equation's uncertainty where that is more (at most one half).
// Supports are proposed by the solver's path and what lies below it
// (SelectSupport); coefficients are those of FitRobustly.
//
// `equation` comes with names, scale and uncertainty; what is regressed,
// candidates, Pareto curve and terms are added. record_starts: first sample of
// each record. without_slope: leaves out candidates that are features as they
// stand (see DiscoverFromNetworks). False for a candidate that cannot be
// evaluated, none that is left, or conditions on what is no candidate; *error
// names the network and the output.
[[nodiscard]] bool RegressOutput(const DiscoveryOptions& options,
                                 const Matrix& features,
                                 const std::vector<Eigen::Index>& record_starts,
                                 const Vector& y, bool without_slope,
                                 DiscoveredEquation* equation,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_OUTPUT_REGRESSION_H_
