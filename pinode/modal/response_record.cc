#include "pinode/modal/response_record.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Shares of a channel's samples at its extreme value, or equal to the one
// before, that a sensor in order does not reach.
constexpr double kClippedShare = 0.005;
constexpr double kRepeatedShare = 0.5;
// Correlation of two channels that are one.
constexpr double kDuplicate = 0.99999;

// Samples that stay at the largest (smallest) value, next to another there.
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

// Over the samples that both have.
double Correlation(const Vector& a, const Vector& b) {
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

std::string Percent(double share) {
  return FormatNumber(100.0 * share, 3) + " %";
}

}  // namespace

bool ResponseRecord::IsValid(std::string* error) const {
  const std::string where = "record '" + name + "'";
  if (channels.empty()) {
    *error = where + " has no channel, expected at least one";
    return false;
  }
  if (!(sampling_step > 0.0) || !std::isfinite(sampling_step)) {
    *error = where + " has a sampling step of " + FormatNumber(sampling_step) +
             " s, expected a positive one";
    return false;
  }
  if (samples.rows() != num_channels()) {
    *error = where + " has " + std::to_string(samples.rows()) +
             " rows of samples for " + std::to_string(num_channels()) +
             " channels";
    return false;
  }
  if (inputs.rows() > 0 &&
      (inputs.cols() != samples.cols() || !inputs.allFinite())) {
    *error = where + " has inputs of " + std::to_string(inputs.cols()) +
             " samples beside responses of " + std::to_string(samples.cols()) +
             ", expected as many, all of them finite";
    return false;
  }
  std::set<std::string> seen;
  for (int c = 0; c < num_channels(); ++c) {
    const ResponseChannel& channel = channels[static_cast<size_t>(c)];
    const std::string at = where + ", channel '" + channel.name + "'";
    if (!seen.insert(channel.name).second) {
      *error = at + ": its name is used twice";
      return false;
    }
    if (channel.derivative < 0 || channel.derivative > 2) {
      *error = at + " is the derivative " + std::to_string(channel.derivative) +
               " of a displacement, expected 0, 1 or 2";
      return false;
    }
    const Vector values = samples.row(c);
    if (values.array().isInf().any()) {
      *error = at + " has an infinite sample";
      return false;
    }
    if (CountPresent(values) < 2 || !(StandardDeviationOfPresent(values) > 0)) {
      *error = at +
               " is dead: all its samples are alike, expected vibrations; "
               "leave it out";
      return false;
    }
  }
  return true;
}

std::vector<std::string> FindChannelFaults(const ResponseRecord& record) {
  std::vector<std::string> faults;
  for (int c = 0; c < record.num_channels(); ++c) {
    const std::string channel =
        "Channel '" + record.channels[static_cast<size_t>(c)].name + "' ";
    const Vector values = record.samples.row(c);
    double lowest = INFINITY;
    double highest = -INFINITY;
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
                       " of its samples are equal to the one before. A sensor "
                       "that hangs, or one read too rarely?");
    } else if (clipped > kClippedShare) {
      faults.push_back(channel + "is clipped: " + Percent(clipped) +
                       " of its samples stay at its extreme values. Damping "
                       "and shapes suffer.");
    }
    for (int other = 0; other < c; ++other) {
      const double correlation = Correlation(values, record.samples.row(other));
      if (std::abs(correlation) < kDuplicate) continue;
      faults.push_back(channel + "is channel '" +
                       record.channels[static_cast<size_t>(other)].name +
                       "' once more (correlation " +
                       FormatNumber(correlation, 7) + ").");
    }
  }
  return faults;
}

}  // namespace pinode
