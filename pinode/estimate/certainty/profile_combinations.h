// Words for what the data hold on to along a profile.

#ifndef PINODE_ESTIMATE_CERTAINTY_PROFILE_COMBINATIONS_H_
#define PINODE_ESTIMATE_CERTAINTY_PROFILE_COMBINATIONS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// `values`: parameters x points of a profile along row `along`, at points where
// the cost is the same. Of each other parameter that follows it, the product or
// the sum that stays: "a * b", "a / b", "a * b^2", "a + 0.5 b"; of those with
// which nothing simple stays, nothing. Rows that hardly move do not follow.
std::vector<std::string> DescribeCombinations(
    const std::vector<std::string>& names, const Matrix& values, int along);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_PROFILE_COMBINATIONS_H_
