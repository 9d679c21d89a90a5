// All supports of a quadratic cost that are nearly as good as the best one.

#ifndef PINODE_DISCOVER_SUPPORT_WINDOW_H_
#define PINODE_DISCOVER_SUPPORT_WINDOW_H_

#include <vector>

#include "pinode/discover/quadratic_face.h"
#include "pinode/discover/stepwise.h"

namespace pinode {

// A support, ascending, and its criterion: the minimum of 2 f over it plus the
// prices of its entries.
struct WeighedSupport {
  std::vector<int> support;
  double criterion = 0.0;
};

// Returns the supports whose criterion is at most `window` above the least one,
// least first (Occam's window: D. Madigan, A. E. Raftery 1994). `start`, with
// the entries that are not optional, is always among them. With prices of the
// Bayesian information criterion, exp(-criterion / 2) is proportional to the
// probability of a support.
//
// The supports are found from `start`, and from the rival that SelectWithout
// gives for each of its entries. The neighbours of each support found differ
// from it by one entry more, one fewer, or one exchanged. At most
// `most_expanded` supports, the best first, have their neighbours looked at.
std::vector<WeighedSupport> SupportsWithin(const QuadraticCost& cost,
                                           const StepwiseOptions& options,
                                           const std::vector<int>& start,
                                           double window, int most_expanded);

}  // namespace pinode

#endif  // PINODE_DISCOVER_SUPPORT_WINDOW_H_
