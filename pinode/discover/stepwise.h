// Stepwise selection of the unknowns of a quadratic cost.

#ifndef PINODE_DISCOVER_STEPWISE_H_
#define PINODE_DISCOVER_STEPWISE_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/quadratic_face.h"

namespace pinode {

struct StepwiseOptions {
  // Per entry: the gain in 2 f that it must exceed, a flag that it may be left
  // out, and the sign that it may have (1, -1; 0: either).
  Vector prices;
  std::vector<bool> optional;
  std::vector<int> signs;
  // Least |theta_j| for which an entry is taken in; 0: none.
  Vector smallest;
};

// Returns the support with the least sum of 2 f and the prices of its entries
// that the following steps find, ascending.
//
// - Start with the entries in `start` and those that are not optional.
// - Remove the entry that loses least beyond its price, until each loses more.
// - Add the entry that gains most beyond its price, until none gains more
//   (M. A. Efroymson 1960).
// - Exchange one entry for another (A. J. Miller 2002).
// - Repeat until nothing changes. Do the same without `start`.
//
// Neither result need be the least: no single change leads from a column that
// is nearly the sum of two to those two. Therefore each entry of the better
// support is held out in turn, and each of the fifty that would gain most is
// held in, while the others are chosen again. This is repeated from each
// improvement. Entries whose columns depend on those taken, within rounding,
// are not taken. Each support that is kept lowers the criterion, so that the
// search ends.
std::vector<int> SelectStepwise(const QuadraticCost& cost,
                                const StepwiseOptions& options,
                                const std::vector<int>& start);

// Returns the support to which the first four of these steps lead from `start`
// if entry `banned` stays out. Descends once: the result is a rival of `start`,
// not the best of all.
std::vector<int> SelectWithout(const QuadraticCost& cost,
                               const StepwiseOptions& options,
                               const std::vector<int>& start, int banned);

// Returns true if an entry of a cost scaled by `scales` may have this value by
// the options' signs and smallest values.
bool IsAllowedValue(const StepwiseOptions& options, const Vector& scales, int j,
                    double value);

// Returns the minimum over the entries in `support`, the others being 0.
Vector MinimizeOn(const QuadraticCost& cost, const std::vector<int>& support);

}  // namespace pinode

#endif  // PINODE_DISCOVER_STEPWISE_H_
