#include "pinode/record/sample_faults.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Factor by which an outlier is farther out than all other samples.
constexpr double kFarther = 4.0;
// Fewest samples, and fewest different values, for a finding.
constexpr Eigen::Index kLeastSamples = 50;
constexpr size_t kLeastValues = 10;
// Number of equal samples in a row that is not chance.
constexpr Eigen::Index kHangs = 20;
// Shares of samples: at the limits of a clipped channel; equal to the one
// before, for a channel that is sampled too rarely and for other channels.
constexpr double kAtLimitShare = 0.005;
constexpr double kHeldShare = 0.45;
constexpr double kSeldom = 0.02;

using Kind = WatchedSignal::Kind;

double MedianOf(const Vector& values) {
  std::vector<double> present;
  present.reserve(static_cast<size_t>(values.size()));
  for (const double value : values) {
    if (!std::isnan(value)) present.push_back(value);
  }
  return Median(std::move(present));
}

// Returns samples in descending order of their sizes, the first `count` of them
// and one more. Missing ones come last, as if they were zero.
std::vector<Eigen::Index> Largest(const Vector& sizes, Eigen::Index count) {
  std::vector<Eigen::Index> order(static_cast<size_t>(sizes.size()));
  for (size_t i = 0; i < order.size(); ++i) {
    order[i] = static_cast<Eigen::Index>(i);
  }
  const auto end = order.begin() + std::min(sizes.size(), count + 1);
  std::partial_sort(
      order.begin(), end, order.end(),
      [&sizes](Eigen::Index a, Eigen::Index b) { return sizes[a] > sizes[b]; });
  order.erase(end, order.end());
  return order;
}

// Returns the largest of `sizes`, at most `most`, that are far from all others.
// With `fewest`, returns no more of them than necessary.
Outliers StandingOff(const Vector& sizes, Eigen::Index most, bool fewest) {
  const std::vector<Eigen::Index> order = Largest(sizes, most);
  Outliers found;
  for (size_t k = 1; k < order.size(); ++k) {
    const double next = sizes[order[k]];
    if (!(next > 0.0) || sizes[order[k - 1]] < kFarther * next) continue;
    found.samples.assign(order.begin(),
                         order.begin() + static_cast<std::ptrdiff_t>(k));
    found.ratio = sizes[order[k - 1]] / next;
    if (fewest) break;
  }
  std::sort(found.samples.begin(), found.samples.end());
  return found;
}

// Returns true if the samples without the outliers are a history on their own.
bool OthersMove(const Vector& values, const Outliers& outliers) {
  std::set<double> different;
  size_t next = 0;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (next < outliers.samples.size() && outliers.samples[next] == k) {
      ++next;
      continue;
    }
    if (!std::isnan(values[k])) different.insert(values[k]);
    if (different.size() >= kLeastValues) return true;
  }
  return false;
}

// Returns distances from the median of two samples before and two behind. 0 if
// the samples on both sides do not agree, as at a step.
Vector DistancesFromNeighbours(const Vector& values) {
  Vector distances = Vector::Zero(values.size());
  for (Eigen::Index k = 2; k + 2 < values.size(); ++k) {
    double around[4] = {values[k - 2], values[k - 1], values[k + 1],
                        values[k + 2]};
    const double difference = std::abs(around[1] - around[2]);
    std::sort(around, around + 4);
    const double distance = std::abs(values[k] - 0.5 * (around[1] + around[2]));
    // NaN where one of them is missing.
    distances[k] = std::isnan(distance + difference) ? 0.0 : distance;
  }
  return distances;
}

bool AreNeighboursAlike(const Vector& values, double distance, Eigen::Index k) {
  return std::abs(values[k - 1] - values[k + 1]) < 0.3 * distance;
}

// Runs of equal samples, and the steps that lead to them.
struct Repeats {
  double held_share = 0.0;    // equal to the one before, but for both ends
  double other_share = 0.0;   // the same without hanging and limits
  double typical_step = 0.0;  // median of the differences that are not zero
  double least_step = 0.0;
  double limit_share = 0.0;    // equal to the one before, at either limit
  double limit_arrival = 0.0;  // median difference on the way to a limit
  // The longest run of a hanging channel. Size 0: none.
  Eigen::Index hang_first = 0;
  Eigen::Index hang_size = 0;
  double hang_departure = 0.0;  // difference on the way out of it
};

Repeats CountRepeats(const Vector& values) {
  const double highest = values.maxCoeff<Eigen::PropagateNumbers>();
  const double lowest = values.minCoeff<Eigen::PropagateNumbers>();
  Repeats repeats;
  std::vector<double> steps, arrivals;
  Eigen::Index held = 0;
  Eigen::Index other = 0;
  Eigen::Index at_limit = 0;
  const Eigen::Index size = values.size();
  for (Eigen::Index first = 0, end = 0; first < size; first = end) {
    end = first + 1;
    while (end < size && values[end] == values[first]) ++end;
    const Eigen::Index length = end - first;
    const double step =
        first > 0 ? std::abs(values[first] - values[first - 1]) : kNaN;
    if (step > 0.0) steps.push_back(step);
    const bool inside = first > 0 && end < size;
    if (inside) held += length - 1;
    if (values[first] == highest || values[first] == lowest) {
      at_limit += length - 1;
      if (length > 1 && step > 0.0) arrivals.push_back(step);
    } else if (inside && length >= kHangs) {
      if (length > repeats.hang_size) {
        repeats.hang_first = first;
        repeats.hang_size = length;
        repeats.hang_departure = std::abs(values[end] - values[first]);
      }
    } else if (inside) {
      other += length - 1;
    }
  }
  const auto total = static_cast<double>(size);
  repeats.held_share = static_cast<double>(held) / total;
  repeats.other_share = static_cast<double>(other) / total;
  repeats.limit_share = static_cast<double>(at_limit) / total;
  if (!steps.empty()) {
    repeats.least_step = *std::min_element(steps.begin(), steps.end());
    repeats.typical_step = Median(std::move(steps));
  }
  if (!arrivals.empty()) repeats.limit_arrival = Median(std::move(arrivals));
  return repeats;
}

class FaultFinder {
 public:
  FaultFinder(const std::vector<WatchedSignal>& signals, double start_time,
              double step, const std::string& time_unit)
      : signals_(signals),
        start_time_(start_time),
        step_(step),
        time_unit_(time_unit) {}

  std::vector<std::string> Find() {
    for (size_t s = 0; s < signals_.size(); ++s) {
      const WatchedSignal& signal = signals_[s];
      if (CountPresent(signal.values) < kLeastSamples ||
          signal.values.array().isInf().any()) {
        continue;
      }
      const Outliers outliers = FindOutliers(signal.values);
      if (!outliers.samples.empty() && !IsExplained(signal, outliers)) {
        faults_.push_back(OutlierText(signal, outliers));
        continue;
      }
      if (signal.kind == Kind::kCovariate) continue;
      AddRepeats(signal);
      if (signal.kind == Kind::kResponse) AddDouble(s);
    }
    return std::move(faults_);
  }

 private:
  std::string Time(Eigen::Index sample) const {
    return FormatNumber(start_time_ + step_ * static_cast<double>(sample), 6) +
           " " + time_unit_;
  }

  static std::string Value(const WatchedSignal& signal, Eigen::Index sample) {
    return FormatNumber(signal.values[sample], 5) +
           (signal.unit == "1" ? "" : " " + signal.unit);
  }

  static std::string Percent(double share) {
    return FormatNumber(100.0 * share, 3) + " %";
  }

  // Returns true if a blow explains the outliers. It does not explain marks of
  // missing samples.
  bool IsExplained(const WatchedSignal& signal,
                   const Outliers& outliers) const {
    if (signal.kind == Kind::kCovariate ||
        (outliers.alike && outliers.samples.size() > 1)) {
      return false;
    }
    return std::all_of(outliers.samples.begin(), outliers.samples.end(),
                       [&](Eigen::Index sample) {
                         return signal.kind == Kind::kLoad
                                    ? ResponsesFollow(sample)
                                    : IsAtABlow(sample);
                       });
  }

  // Returns true if a response moves more after a sample than before it.
  bool ResponsesFollow(Eigen::Index sample) const {
    constexpr Eigen::Index kLookedAt = 30;
    constexpr Eigen::Index kLeast = 5;
    constexpr double kMore = 3.0;
    for (const WatchedSignal& response : signals_) {
      if (response.kind != Kind::kResponse) continue;
      const Vector& values = response.values;
      const Eigen::Index size = values.size();
      const Eigen::Index before = std::min(sample - 1, kLookedAt);
      const Eigen::Index behind = std::min(size - 1 - sample, kLookedAt);
      // Without enough samples to compare, it may well be a blow.
      if (before < kLeast || behind < kLeast) return true;
      const auto path = [&values](Eigen::Index first, Eigen::Index count) {
        return (values.segment(first + 1, count) - values.segment(first, count))
                   .lpNorm<1>() /
               static_cast<double>(count);
      };
      if (path(sample, behind) > kMore * path(sample - 1 - before, before)) {
        return true;
      }
    }
    return false;
  }

  // Returns true if a load that is small at most times is large then.
  bool IsAtABlow(Eigen::Index sample) const {
    constexpr double kLarge = 0.3;
    constexpr double kSmall = 0.02;
    for (const WatchedSignal& load : signals_) {
      if (load.kind != Kind::kLoad || CountPresent(load.values) == 0) continue;
      const Vector sizes =
          (load.values.array() - MedianOf(load.values)).abs().matrix();
      const double largest = sizes.maxCoeff<Eigen::PropagateNumbers>();
      const Eigen::Index first = std::max<Eigen::Index>(0, sample - 2);
      const Eigen::Index count =
          std::min(sizes.size() - first, sample + 3 - first);
      if (MedianOf(sizes) < kSmall * largest &&
          sizes.segment(first, count).maxCoeff<Eigen::PropagateNumbers>() >=
              kLarge * largest) {
        return true;
      }
    }
    return false;
  }

  std::string OutlierText(const WatchedSignal& signal,
                          const Outliers& outliers) const {
    const size_t count = outliers.samples.size();
    const Eigen::Index first = outliers.samples[0];
    const std::string far = FormatNumber(std::round(outliers.ratio), 6) +
                            " times as far out as any other";
    std::string text = signal.label + ": ";
    if (count == 1) {
      text += "the sample at " + Time(first) + ", " + Value(signal, first) +
              ", is " + far + ". Check this sample.";
    } else if (outliers.alike) {
      text += std::to_string(count) + " samples are " + Value(signal, first) +
              ", the first at " + Time(first) + ", " + far +
              ". Check whether they mark missing samples.";
    } else {
      text += std::to_string(count) + " samples, the first at " + Time(first) +
              " (" + Value(signal, first) + "), are " + far +
              ". Check these samples.";
    }
    if (signal.kind != Kind::kLoad) {
      return text + " Empty cells are read as missing.";
    }
    return text +
           " The structure did not feel them. Correct them, or choose a window "
           "without them.";
  }

  void AddRepeats(const WatchedSignal& signal) {
    constexpr double kSteps = 5.0;  // of the logger's resolution
    constexpr double kFast = 0.2;   // of a typical difference
    constexpr double kMostAtLimit = 0.3;
    const Repeats repeats = CountRepeats(signal.values);
    const bool is_load = signal.kind == Kind::kLoad;
    const bool seldom = repeats.other_share < kSeldom;
    // A response that comes to rest naturally does so slowly.
    const auto is_sudden = [&repeats](double step) {
      return step > kFast * repeats.typical_step &&
             step > kSteps * repeats.least_step;
    };
    if (!is_load && repeats.held_share > kHeldShare &&
        repeats.typical_step > kSteps * repeats.least_step) {
      faults_.push_back(signal.label + ": " + Percent(repeats.held_share) +
                        " of its samples are equal to the one before. Check "
                        "whether the sensor hangs or is read too rarely.");
    } else if (repeats.hang_size > 0 && seldom &&
               is_sudden(repeats.hang_departure) &&
               !(is_load && signal.values[repeats.hang_first] == 0.0)) {
      faults_.push_back(
          signal.label + ": stays at " + Value(signal, repeats.hang_first) +
          " for " + std::to_string(repeats.hang_size) + " samples from " +
          Time(repeats.hang_first) + " on. Check whether the sensor hangs. " +
          (is_load ? "Correct the samples, or choose a window without them."
                   : "Empty cells are read as missing."));
    } else if (repeats.limit_share > kAtLimitShare && seldom &&
               repeats.limit_share < kMostAtLimit &&
               is_sudden(repeats.limit_arrival)) {
      faults_.push_back(signal.label + ": is clipped, " +
                        Percent(repeats.limit_share) +
                        " of its samples are at its extreme values. Results "
                        "from it become less accurate.");
    }
  }

  // Adds a finding if the response `index` repeats an earlier one, sample by
  // sample.
  void AddDouble(size_t index) {
    const WatchedSignal& signal = signals_[index];
    if (!(StandardDeviationOfPresent(signal.values) > 0.0)) return;
    for (size_t other = 0; other < index; ++other) {
      const WatchedSignal& earlier = signals_[other];
      if (earlier.kind != Kind::kResponse ||
          !(earlier.values.array() == signal.values.array() ||
            (earlier.values.array().isNaN() && signal.values.array().isNaN()))
               .all()) {
        continue;
      }
      faults_.push_back(signal.label + ": is " + earlier.label +
                        " again, sample by sample.");
      return;
    }
  }

  const std::vector<WatchedSignal>& signals_;
  const double start_time_;
  const double step_;
  const std::string& time_unit_;
  std::vector<std::string> faults_;
};

}  // namespace

Outliers FindOutliers(const Vector& values) {
  const Eigen::Index present = CountPresent(values);
  if (present < kLeastSamples) return Outliers();
  const double median = MedianOf(values);
  const Vector sizes = values.unaryExpr([median](double value) {
    return std::isnan(value) ? 0.0 : std::abs(value - median);
  });
  Eigen::Index farthest = 0;
  sizes.maxCoeff(&farthest);
  const Eigen::Index alike = (values.array() == values[farthest]).count();
  const Eigen::Index few = std::max<Eigen::Index>(10, present / 1000);
  // A channel that is off half of the time gives no information.
  Outliers found =
      StandingOff(sizes, std::min(std::max(few, alike), present / 3),
                  /*fewest=*/false);
  if (static_cast<Eigen::Index>(found.samples.size()) > few &&
      static_cast<Eigen::Index>(found.samples.size()) != alike) {
    found = Outliers();
  }
  if (found.samples.empty()) {
    const Vector distances = DistancesFromNeighbours(values);
    found = StandingOff(distances, std::min(few, present / 10),
                        /*fewest=*/true);
    const bool single = std::all_of(
        found.samples.begin(), found.samples.end(), [&](Eigen::Index k) {
          return AreNeighboursAlike(values, distances[k], k);
        });
    if (!single) return Outliers();
  }
  if (found.samples.empty() || !OthersMove(values, found)) return Outliers();
  found.alike = std::all_of(
      found.samples.begin(), found.samples.end(),
      [&](Eigen::Index k) { return values[k] == values[found.samples[0]]; });
  return found;
}

std::vector<std::string> FindSampleFaults(
    const std::vector<WatchedSignal>& signals, double start_time, double step,
    const std::string& time_unit) {
  return FaultFinder(signals, start_time, step, time_unit).Find();
}

}  // namespace pinode
