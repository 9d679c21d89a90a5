// Which unknowns a quadratic cost asks for, one after the other.

#ifndef PINODE_DISCOVER_STEPWISE_H_
#define PINODE_DISCOVER_STEPWISE_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// A negative log-likelihood near its minimum,
//
//   f(theta) = gradient' theta + 1/2 theta' hessian theta + constant,
//
// such as multiple shooting has for the coefficients of a library in its
// equation of motion: there theta = 0 is the model without the candidates.
struct QuadraticCost {
  Vector gradient;  // at theta = 0
  Matrix hessian;   // positive semidefinite
};

struct StepwiseOptions {
  // Of each entry: what it must gain in 2 f, whether it may be left out at all,
  // and the sign that it may have (1, -1; 0: either).
  Vector prices;
  std::vector<bool> optional;
  std::vector<int> signs;
  // Least |theta_j| for which an entry is taken in; 0: none.
  Vector smallest;
};

// The support with the least 2 f + prices of its entries that these steps lead
// to. Beginning with the entries in `start` and those that are not optional,
// the entry that loses least beyond its price is left out, until each loses
// more; then the one that gains most beyond its price is taken in, until none
// gains more (M. A. Efroymson 1960); then one is exchanged for another (A. J.
// Miller 2002); and again until nothing changes. The same without `start`.
// Neither need be the least: no single change leads from a column that is
// nearly the sum of two to those two. So each entry of the better support is
// held out in turn, and each of the fifty that would gain most held in, while
// the others are chosen anew around it, and all that again from what is better.
// Entries whose columns depend on those taken, within rounding, are not taken.
// Each support that is kept lowers the criterion, so that it ends. Ascending.
std::vector<int> SelectStepwise(const QuadraticCost& cost,
                                const StepwiseOptions& options,
                                const std::vector<int>& start);

// The minimum over the entries in `support`, the others being 0.
Vector MinimizeOn(const QuadraticCost& cost, const std::vector<int>& support);

}  // namespace pinode

#endif  // PINODE_DISCOVER_STEPWISE_H_
