// Text for combinations that stay constant along a profile.

#ifndef PINODE_ESTIMATE_CERTAINTY_PROFILE_COMBINATIONS_H_
#define PINODE_ESTIMATE_CERTAINTY_PROFILE_COMBINATIONS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Describes the combinations that stay constant along a profile. `values`:
// parameters x points of a profile along row `along`, at points of equal cost.
// For each other parameter that follows it, returns the constant product or
// sum: "a * b", "a / b", "a * b^2", "a + 0.5 b". Parameters without a simple
// combination are left out. Rows that hardly move do not follow.
std::vector<std::string> DescribeCombinations(
    const std::vector<std::string>& names, const Matrix& values, int along);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_PROFILE_COMBINATIONS_H_
