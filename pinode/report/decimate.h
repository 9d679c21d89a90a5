// Decimation of histories for figures.

#ifndef PINODE_REPORT_DECIMATE_H_
#define PINODE_REPORT_DECIMATE_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Values of a history in a vector, or in a row of a matrix (its transpose),
// without a copy.
using HistoryRef = Eigen::Ref<const Vector, 0, Eigen::InnerStride<>>;

// Points of a line; a NaN in y interrupts it.
struct Polyline {
  std::vector<double> x, y;
};

// Returns the history (x ascending, as long as y) with at most about 2 *
// num_buckets points. Every bucket of consecutive samples keeps its smallest
// and largest value, in their order, so that no peak is lost. The first and the
// last value stay. Values that are not finite are missing: gaps longer than
// usual remain gaps. Histories of up to 2 * num_buckets samples are kept whole.
Polyline DecimateHistory(const HistoryRef& x, const HistoryRef& y,
                         int num_buckets);
// Decimates over a uniform grid, x = first, first + step, ...
Polyline DecimateHistory(double first, double step, const HistoryRef& y,
                         int num_buckets);

}  // namespace pinode

#endif  // PINODE_REPORT_DECIMATE_H_
