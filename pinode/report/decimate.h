// Fewer points for the same picture.

#ifndef PINODE_REPORT_DECIMATE_H_
#define PINODE_REPORT_DECIMATE_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Values of a history, wherever they lie: a vector, or a row of a matrix (its
// transpose), without a copy.
using HistoryRef = Eigen::Ref<const Vector, 0, Eigen::InnerStride<>>;

// Points of a line; a NaN in y lifts the pen.
struct Polyline {
  std::vector<double> x, y;
};

// The history (x ascending, as long as y) with at most about 2 * num_buckets
// points: of every bucket of consecutive samples the smallest and the largest,
// in their order, so that no peak is lost; the first and the last value stay.
// Values that are not finite are missing: longer gaps than usual remain gaps.
// Histories of up to 2 * num_buckets samples are kept whole.
Polyline DecimateHistory(const HistoryRef& x, const HistoryRef& y,
                         int num_buckets);
// Of a uniform grid, x = first, first + step, ...
Polyline DecimateHistory(double first, double step, const HistoryRef& y,
                         int num_buckets);

}  // namespace pinode

#endif  // PINODE_REPORT_DECIMATE_H_
