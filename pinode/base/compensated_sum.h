// Sums in twice the working precision. Their results hardly depend on the order
// of the terms.

#ifndef PINODE_BASE_COMPENSATED_SUM_H_
#define PINODE_BASE_COMPENSATED_SUM_H_

#include <algorithm>

#include "pinode/base/types.h"

namespace pinode {

// Computes (*sum + *rest) += term, elementwise. The rounding error of *sum goes
// to *rest (D. E. Knuth's TwoSum; T. Ogita, S. M. Rump, S. Oishi, SIAM J. Sci.
// Comput. 26 (2005) 1955-1988). All three have the same size, and none overlaps
// another.
inline void AddCompensated(const Eigen::Ref<const Vector>& term,
                           Eigen::Ref<Vector> sum, Eigen::Ref<Vector> rest) {
  // Number of entries that fit into the fastest cache.
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
