#include "pinode/report/decimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pinode/base/logging.h"

namespace pinode {

namespace {

// Decimates a history; `x` gives the abscissa of a sample.
template <typename Abscissa>
Polyline Decimate(const Abscissa& x, const HistoryRef& y, int num_buckets) {
  CHECK_GT(num_buckets, 0);
  Polyline line;
  const Eigen::Index present = y.array().isFinite().count();
  if (present == 0) return line;
  // A sensor at a lower rate misses samples regularly: a gap lasts longer than
  // twice the usual distance between its values.
  const double longest_distance =
      2.0 * static_cast<double>(y.size()) / static_cast<double>(present);
  Eigen::Index last = -1;  // last sample taken
  const auto take = [&](Eigen::Index i) {
    if (i <= last) return;
    Eigen::Index previous = last;
    for (Eigen::Index k = last + 1; k <= i && last >= 0; ++k) {
      if (!std::isfinite(y(k))) continue;
      if (static_cast<double>(k - previous) > longest_distance) {
        line.x.push_back(x(previous + 1));
        line.y.push_back(std::numeric_limits<double>::quiet_NaN());
        break;
      }
      previous = k;
    }
    last = i;
    line.x.push_back(x(i));
    line.y.push_back(y(i));
  };

  const Eigen::Index size = y.size();
  const Eigen::Index buckets =
      size <= Eigen::Index{2} * num_buckets ? size : num_buckets;
  Eigen::Index final_sample = -1;
  for (Eigen::Index bucket = 0; bucket < buckets; ++bucket) {
    const Eigen::Index begin = bucket * size / buckets;
    const Eigen::Index end = (bucket + 1) * size / buckets;
    Eigen::Index lowest = -1, highest = -1;
    for (Eigen::Index i = begin; i < end; ++i) {
      if (!std::isfinite(y(i))) continue;
      if (lowest < 0 || y(i) < y(lowest)) lowest = i;
      if (highest < 0 || y(i) > y(highest)) highest = i;
      final_sample = i;
    }
    if (lowest < 0) continue;
    if (last < 0) {
      for (Eigen::Index i = begin; i < end && last < 0; ++i) {
        if (std::isfinite(y(i))) take(i);
      }
    }
    take(std::min(lowest, highest));
    take(std::max(lowest, highest));
  }
  if (final_sample >= 0) take(final_sample);
  return line;
}

}  // namespace

Polyline DecimateHistory(const HistoryRef& x, const HistoryRef& y,
                         int num_buckets) {
  CHECK_EQ(x.size(), y.size()) << "one abscissa per ordinate";
  return Decimate(x, y, num_buckets);
}

Polyline DecimateHistory(double first, double step, const HistoryRef& y,
                         int num_buckets) {
  return Decimate(
      [=](Eigen::Index i) { return first + static_cast<double>(i) * step; }, y,
      num_buckets);
}

}  // namespace pinode
