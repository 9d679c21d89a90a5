// Sums to twice the digits, so that next to nothing depends on their order.

#ifndef PINODE_BASE_COMPENSATED_SUM_H_
#define PINODE_BASE_COMPENSATED_SUM_H_

#include <algorithm>

#include "pinode/base/types.h"

namespace pinode {

// (*sum + *rest) += term, elementwise: what rounding takes from *sum goes to
// *rest (D. E. Knuth's TwoSum; T. Ogita, S. M. Rump, S. Oishi, SIAM J. Sci.
// Comput. 26 (2005) 1955-1988). All of one size; none overlaps another.
inline void AddCompensated(const Eigen::Ref<const Vector>& term,
                           Eigen::Ref<Vector> sum, Eigen::Ref<Vector> rest) {
  // As much as stays in the fastest cache.
  constexpr Eigen::Index kChunk = 256;
  Eigen::Array<double, kChunk, 1> before, with, share;
  for (Eigen::Index first = 0; first < term.size(); first += kChunk) {
    const Eigen::Index count = std::min(kChunk, term.size() - first);
    const auto x = term.segment(first, count).array();
    before.head(count) = sum.segment(first, count).array();
    with.head(count) = before.head(count) + x;
    share.head(count) = with.head(count) - before.head(count);
    rest.segment(first, count).array() +=
        (before.head(count) - (with.head(count) - share.head(count))) +
        (x - share.head(count));
    sum.segment(first, count) = with.head(count).matrix();
  }
}

}  // namespace pinode

#endif  // PINODE_BASE_COMPENSATED_SUM_H_
