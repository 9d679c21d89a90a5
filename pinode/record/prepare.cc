#include "pinode/record/prepare.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Rounding of a time given in decimals, as a fraction of the step.
constexpr double kSameTime = 1e-6;

}  // namespace

std::vector<Gap> FindGaps(const Vector& values) {
  std::vector<Gap> gaps;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (!std::isnan(values[i])) continue;
    if (i > 0 && std::isnan(values[i - 1])) {
      ++gaps.back().size;
    } else {
      gaps.push_back({i, 1});
    }
  }
  return gaps;
}

double RemoveOffset(Vector* values) {
  CHECK(values != nullptr);
  const double mean = MeanOfPresent(*values);
  if (std::isnan(mean)) return 0.0;
  values->array() -= mean;
  return mean;
}

Vector FillMissing(const Vector& values) {
  CHECK_GT(CountPresent(values), 0)
      << "all samples are missing, so the gaps cannot be filled";
  Vector filled = values;
  for (const Gap& gap : FindGaps(values)) {
    const Eigen::Index after = gap.first + gap.size;
    const bool at_begin = gap.first == 0;
    const bool at_end = after == values.size();
    const double left = values[at_begin ? after : gap.first - 1];
    const double right = values[at_end ? gap.first - 1 : after];
    for (Eigen::Index i = 0; i < gap.size; ++i) {
      const double x =
          static_cast<double>(i + 1) / static_cast<double>(gap.size + 1);
      filled[gap.first + i] = at_begin || at_end ? (at_begin ? right : left)
                                                 : (1.0 - x) * left + x * right;
    }
  }
  return filled;
}

void CopyMissing(const Vector& pattern, Vector* values) {
  CHECK(values != nullptr);
  CHECK_EQ(pattern.size(), values->size());
  for (Eigen::Index i = 0; i < pattern.size(); ++i) {
    if (std::isnan(pattern[i])) (*values)[i] = pattern[i];
  }
}

bool ConvertChannel(Dimension dimension, const UnitSystem& system, int sign,
                    Channel* channel, std::string* error) {
  CHECK(channel != nullptr);
  CHECK(error != nullptr);
  CHECK(sign == 1 || sign == -1) << "sign is " << sign << ", expected 1 or -1";
  double factor = 0.0;
  if (!UnitFactor(channel->unit, dimension, system, &factor, error)) {
    *error = "channel '" + channel->name + "': " + *error;
    return false;
  }
  channel->values *= sign * factor;
  channel->unit = UnitName(dimension, system);
  return true;
}

bool SelectWindow(const Record& record, double from, double to, Record* window,
                  std::string* error) {
  CHECK(window != nullptr);
  CHECK(error != nullptr);
  const double step = record.sampling_step;
  const Eigen::Index num_samples = record.num_samples();
  const double end_time = record.time(num_samples - 1);
  const std::string what = "record '" + record.name + "': window [" +
                           FormatNumber(from, 10) + ", " +
                           FormatNumber(to, 10) + "] ";
  if (!(from < to)) {
    *error = what + "is empty, expected its begin before its end";
    return false;
  }
  // 30 s at 100 Hz end at 29.99 s, and still count as 30 s.
  const double slack = (1.0 + kSameTime) * step;
  if (from < record.start_time - slack || to > end_time + slack) {
    *error = what + "reaches beyond the record, which lasts from " +
             FormatNumber(record.start_time, 10) + " to " +
             FormatNumber(end_time, 10);
    return false;
  }
  const auto first = std::max<Eigen::Index>(
      0, static_cast<Eigen::Index>(
             std::ceil((from - record.start_time) / step - kSameTime)));
  const Eigen::Index last = std::min(
      num_samples - 1, static_cast<Eigen::Index>(std::floor(
                           (to - record.start_time) / step + kSameTime)));
  if (last <= first) {
    *error = what + "holds fewer than two samples (the step is " +
             FormatNumber(step, 6) + ")";
    return false;
  }
  Record result;
  result.name = record.name;
  result.start_time = record.time(first);
  result.sampling_step = step;
  for (const Channel& channel : record.channels) {
    result.channels.push_back(
        {channel.name, channel.unit,
         channel.values.segment(first, last - first + 1)});
  }
  *window = std::move(result);
  return true;
}

}  // namespace pinode
