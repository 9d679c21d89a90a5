#include "pinode/record/channel_faults.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/record/sample_faults.h"

namespace pinode {
namespace {

// Shares of a channel's samples at its extreme value, or equal to the one
// before, that a working sensor does not reach.
constexpr double kClippedShare = 0.005;
constexpr double kRepeatedShare = 0.5;
// Correlation above which two channels count as equal.
constexpr double kDuplicate = 0.99999;

// Returns the share of samples at the largest (smallest) value that have a
// neighbour there.
double ShareAtLimit(const Vector& values, double limit) {
  Eigen::Index count = 0;
  for (Eigen::Index k = 1; k < values.size(); ++k) {
    if (values[k] == limit && values[k - 1] == limit) ++count;
  }
  return static_cast<double>(count) / static_cast<double>(values.size());
}

double ShareRepeated(const Vector& values) {
  Eigen::Index count = 0;
  for (Eigen::Index k = 1; k < values.size(); ++k) {
    if (values[k] == values[k - 1]) ++count;
  }
  return static_cast<double>(count) / static_cast<double>(values.size());
}

std::string Percent(double share) {
  return FormatNumber(100.0 * share, 3) + " %";
}

}  // namespace

double CorrelationOfPresent(const Vector& a, const Vector& b) {
  double aa = 0.0;
  double bb = 0.0;
  double ab = 0.0;
  const double mean_a = MeanOfPresent(a);
  const double mean_b = MeanOfPresent(b);
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    const double x = a[k] - mean_a;
    const double y = b[k] - mean_b;
    if (std::isnan(x) || std::isnan(y)) continue;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

std::string WhyChannelIsUseless(const Vector& values) {
  if (values.array().isInf().any()) return "has an infinite sample";
  if (CountPresent(values) < 2 || !(StandardDeviationOfPresent(values) > 0.0)) {
    return "is dead: all its samples are equal; leave it out";
  }
  return "";
}

std::vector<std::string> FindChannelFaults(
    const std::vector<std::string>& channels, const Matrix& samples) {
  std::vector<std::string> faults;
  for (size_t c = 0; c < channels.size(); ++c) {
    const std::string channel = "Channel '" + channels[c] + "' ";
    const Vector values = samples.row(static_cast<Eigen::Index>(c));
    double lowest = kInfinity;
    double highest = -kInfinity;
    for (const double value : values) {
      if (std::isnan(value)) continue;
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
    const double clipped =
        ShareAtLimit(values, highest) + ShareAtLimit(values, lowest);
    const double repeated = ShareRepeated(values);
    if (repeated > kRepeatedShare) {
      faults.push_back(channel + "repeats itself: " + Percent(repeated) +
                       " of its samples are equal to the one before. Check "
                       "whether the sensor hangs or is read too rarely.");
    } else if (clipped > kClippedShare) {
      faults.push_back(channel + "is clipped: " + Percent(clipped) +
                       " of its samples are at its extreme values. Damping and "
                       "shapes become less accurate.");
    }
    const Outliers outliers = FindOutliers(values);
    if (outliers.alike && outliers.samples.size() > 1) {
      faults.push_back(
          channel + "has " + std::to_string(outliers.samples.size()) +
          " samples of " + FormatNumber(values[outliers.samples[0]], 6) +
          " (unit and gain applied; the first is sample " +
          std::to_string(outliers.samples[0] + 1) +
          "), far from all others: perhaps a code for missing "
          "values. Write nan in their place.");
    }
    for (size_t other = 0; other < c; ++other) {
      const double correlation = CorrelationOfPresent(
          values, samples.row(static_cast<Eigen::Index>(other)));
      if (std::abs(correlation) < kDuplicate) continue;
      faults.push_back(channel + "is channel '" + channels[other] +
                       "' again (correlation " + FormatNumber(correlation, 7) +
                       ").");
    }
  }
  return faults;
}

}  // namespace pinode
