#include "pinode/case/draft/load_interpolation.h"

#include <cmath>

#include "pinode/base/statistics.h"

namespace pinode {
namespace {

// Error of the cubic, over that of the line, below which a load is smooth.
// Measured: 0.34 for the forces of data/frame, which are smooth, and 0.91 for
// the ground of data/three_storey, which is straight between the samples. White
// noise has 1.05, a sine of 0.15 (0.2) of the sampling rate 0.53 (0.80).
constexpr double kSmoothRatio = 0.7;

}  // namespace

LoadInterpolation FindLoadInterpolation(const std::vector<Vector>& loads) {
  LoadInterpolation result;
  double linear = 0.0;
  double cubic = 0.0;
  for (const Vector& load : loads) {
    const double mean = MeanOfPresent(load);
    double motion = 0.0;
    double linear_sum = 0.0;
    double cubic_sum = 0.0;
    for (Eigen::Index k = 3; k + 3 < load.size(); ++k) {
      const double near = load[k - 1] + load[k + 1];
      const double far = load[k - 3] + load[k + 3];
      const double by_line = load[k] - 0.5 * near;
      const double by_cubic = load[k] - (9.0 * near - far) / 16.0;
      if (std::isnan(by_line) || std::isnan(by_cubic)) continue;
      linear_sum += by_line * by_line;
      cubic_sum += by_cubic * by_cubic;
      motion += (load[k] - mean) * (load[k] - mean);
    }
    if (!(motion > 0.0)) continue;
    linear += linear_sum / motion;
    cubic += cubic_sum / motion;
    result.is_cubic = false;
  }
  if (result.is_cubic) return result;
  const auto count = static_cast<double>(loads.size());
  result.linear_error = std::sqrt(linear / count);
  result.cubic_error = std::sqrt(cubic / count);
  result.is_cubic = cubic <= kSmoothRatio * kSmoothRatio * linear;
  return result;
}

}  // namespace pinode
