#include "pinode/watch/sensor_history.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <deque>
#include <map>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/watch/channel_shape.h"
#include "pinode/watch/mode_histories.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 6.283185307179586;
constexpr size_t kFewestModes = 3;
constexpr size_t kFewestChannels = 3;
// With three channels the loss of 30 % in the first of eight storeys is also
// the gain of the first channel (sensor_history_test.cc).
constexpr size_t kFewestGainChannels = 4;
// Records that must agree, of the last ones.
constexpr int kAgreeing = 3;
constexpr size_t kLast = 5;
// A change counts if the misfit of the shapes is beyond this multiple of what
// 95 % of the reference's records stay below, and if the fault explains most of
// it. Losses of 2 to 60 % in each spring of a chain name no sensor then
// (sensor_history_test.cc).
constexpr double kLeastMisfit = 2.0;
constexpr double kMostUnexplained = 0.3;
// Gains nearer to one are no fault, and a simpler fault is preferred unless
// another leaves less than this share of its misfit.
constexpr double kLeastGainChange = 0.1;
constexpr double kMuchBetter = 0.6;

// Mode in the reference.
struct Normal {
  double log_frequency = 0.0;
  ChannelShape shape;
  double misfit = 0.0;  // mean of 1 - MAC over the reference
};

// Shape of a mode of a record beside that of the reference.
struct Pair {
  const Normal* normal = nullptr;
  double frequency_hz = 0.0;
  ChannelShape shape;
};

// MAC of a pair as a function of single entries. With another entry of one
// channel only a few terms of its sums change.
struct PairSums {
  double frequency_hz = 0.0;
  double normal_misfit = 0.0;
  Complex ab;
  double aa = 0.0;
  double bb = 0.0;
  // Entries at the channels that all pairs have.
  std::vector<Complex> normal, value;

  // 1 - MAC relative to its mean in the reference.
  double Misfit(Complex changed_ab, double changed_bb) const {
    const double square = aa * changed_bb;
    const double mac = square > 0.0 ? std::norm(changed_ab) / square : 1.0;
    return std::max(0.0, 1.0 - mac) / normal_misfit;
  }
  // Summand of ab.
  Complex Product(size_t channel) const {
    return std::conj(normal[channel]) * value[channel];
  }
};

struct Fault {
  std::vector<std::string> channels;
  std::string kind;
  std::vector<std::string> texts;  // for each channel
  double misfit = kInfinity;
};

class Comparison {
 public:
  Comparison(const std::vector<bool>& is_reference,
             const TrackingOptions& options,
             const std::vector<StoredRecord>& records)
      : options_(options) {
    std::vector<StoredRecord> reference;
    for (size_t r = 0; r < records.size(); ++r) {
      if (is_reference[r]) reference.push_back(records[r]);
    }
    for (const ModeHistory& history : JoinModes(reference, options)) {
      if (static_cast<double>(history.points.size()) >=
          options.least_presence * static_cast<double>(reference.size())) {
        AddNormal(reference, history);
      }
    }
    std::vector<double> misfits;
    for (const StoredRecord& record : reference) {
      const std::vector<Pair> pairs = PairsOf(record);
      if (!pairs.empty()) misfits.push_back(Misfit(pairs));
    }
    if (misfits.empty()) return;
    std::sort(misfits.begin(), misfits.end());
    limit_ = kLeastMisfit * misfits[misfits.size() * 95 / 100];
  }

  // Returns the fault of a sensor; without a channel: none.
  Fault Find(const StoredRecord& record) const {
    const std::vector<Pair> pairs = PairsOf(record);
    if (pairs.size() < kFewestModes) return {};
    const std::vector<std::string> channels = CommonChannels(pairs);
    if (channels.size() < kFewestChannels) return {};
    const double misfit = Misfit(pairs);
    if (!(misfit > limit_)) return {};
    Fault best;
    const std::vector<PairSums> sums = SumsOf(pairs, channels);
    // Simple faults first, until one explains all.
    for (const auto find : {&Comparison::Turned, &Comparison::Swapped,
                            &Comparison::Scaled, &Comparison::Late}) {
      const Fault fault = (this->*find)(sums, channels);
      if (fault.misfit < kMuchBetter * best.misfit) best = fault;
      if (best.misfit <= std::min(limit_, kMostUnexplained * misfit)) break;
    }
    return best.misfit <= kMostUnexplained * misfit ? best : Fault();
  }

 private:
  void AddNormal(const std::vector<StoredRecord>& reference,
                 const ModeHistory& history) {
    Normal normal;
    double count = 0.0;
    std::map<std::string, double> counts;
    for (const ModeHistory::Point& point : history.points) {
      const StoredRecord& record = reference[static_cast<size_t>(point.record)];
      const StoredMode& mode = record.modes[static_cast<size_t>(point.mode)];
      const ChannelShape shape = ShapeOf(record, mode);
      count += 1.0;
      normal.log_frequency +=
          (std::log(mode.frequency_hz) - normal.log_frequency) / count;
      const ShapeProducts products(normal.shape, shape);
      normal.misfit += (products.OneMinusMac() - normal.misfit) / count;
      const double size = std::abs(products.ab);
      const Complex factor = size > 0.0 ? std::sqrt(products.aa / products.bb) *
                                              std::conj(products.ab) / size
                                        : Complex(1.0);
      for (const auto& [name, value] : shape) {
        Complex& mean = normal.shape[name];
        mean += (factor * value - mean) / (counts[name] += 1.0);
      }
    }
    normal.misfit = std::max(normal.misfit, 1e-9);
    normals_.push_back(std::move(normal));
  }

  // Pairs each mode of the reference with the nearest one of the record.
  // Shapes must not decide, as a fault changes them.
  std::vector<Pair> PairsOf(const StoredRecord& record) const {
    std::map<size_t, std::pair<double, const Normal*>> nearest;  // by mode
    for (const Normal& normal : normals_) {
      double least = options_.largest_step;
      size_t mode = record.modes.size();
      for (size_t m = 0; m < record.modes.size(); ++m) {
        const double step = std::abs(std::log(record.modes[m].frequency_hz) -
                                     normal.log_frequency);
        if (step < least) {
          least = step;
          mode = m;
        }
      }
      if (mode == record.modes.size()) continue;
      const auto [place, is_new] =
          nearest.emplace(mode, std::make_pair(least, &normal));
      if (!is_new && least < place->second.first) {
        place->second = {least, &normal};
      }
    }
    std::vector<Pair> pairs;
    for (const auto& [m, found] : nearest) {
      pairs.push_back({found.second, record.modes[m].frequency_hz,
                       ShapeOf(record, record.modes[m])});
    }
    return pairs;
  }

  static std::vector<std::string> CommonChannels(
      const std::vector<Pair>& pairs) {
    std::vector<std::string> channels;
    for (const auto& entry : pairs.front().shape) {
      const std::string& name = entry.first;
      if (std::all_of(pairs.begin(), pairs.end(), [&name](const Pair& pair) {
            return pair.shape.count(name) > 0 &&
                   pair.normal->shape.count(name) > 0;
          })) {
        channels.push_back(name);
      }
    }
    return channels;
  }

  // Mean of 1 - MAC over the modes, each relative to its mean in the reference.
  static double Misfit(const std::vector<Pair>& pairs) {
    double sum = 0.0;
    for (const Pair& pair : pairs) {
      sum += ShapeProducts(pair.normal->shape, pair.shape).OneMinusMac() /
             pair.normal->misfit;
    }
    return sum / static_cast<double>(pairs.size());
  }

  static std::vector<PairSums> SumsOf(
      const std::vector<Pair>& pairs,
      const std::vector<std::string>& channels) {
    std::vector<PairSums> all;
    for (const Pair& pair : pairs) {
      const ShapeProducts products(pair.normal->shape, pair.shape);
      PairSums sums;
      sums.frequency_hz = pair.frequency_hz;
      sums.normal_misfit = pair.normal->misfit;
      sums.ab = products.ab;
      sums.aa = products.aa;
      sums.bb = products.bb;
      for (const std::string& channel : channels) {
        sums.normal.push_back(pair.normal->shape.at(channel));
        sums.value.push_back(pair.shape.at(channel));
      }
      all.push_back(std::move(sums));
    }
    return all;
  }

  // Mean over the pairs of what `value` returns for each.
  template <typename Value>
  static double Mean(const std::vector<PairSums>& pairs, const Value& value) {
    double sum = 0.0;
    for (const PairSums& pair : pairs) sum += value(pair);
    return sum / static_cast<double>(pairs.size());
  }

  Fault Turned(const std::vector<PairSums>& pairs,
               const std::vector<std::string>& channels) const {
    Fault best;
    for (size_t c = 0; c < channels.size(); ++c) {
      const double misfit = Mean(pairs, [c](const PairSums& pair) {
        return pair.Misfit(pair.ab - 2.0 * pair.Product(c), pair.bb);
      });
      if (misfit >= best.misfit) continue;
      best = {{channels[c]},
              "turned",
              {"is turned: its sign is opposite to that of the reference in "
               "every mode."},
              misfit};
    }
    return best;
  }

  Fault Swapped(const std::vector<PairSums>& pairs,
                const std::vector<std::string>& channels) const {
    Fault best;
    for (size_t a = 0; a < channels.size(); ++a) {
      for (size_t b = a + 1; b < channels.size(); ++b) {
        const double misfit = Mean(pairs, [a, b](const PairSums& pair) {
          const Complex change = std::conj(pair.normal[a] - pair.normal[b]) *
                                 (pair.value[b] - pair.value[a]);
          return pair.Misfit(pair.ab + change, pair.bb);
        });
        if (misfit >= best.misfit) continue;
        best = {{channels[a], channels[b]},
                "swapped",
                {"is swapped with '" + channels[b] + "'.",
                 "is swapped with '" + channels[a] + "'."},
                misfit};
      }
    }
    return best;
  }

  // The real factor of a channel, relative to what the other channels let
  // expect.
  static double GainOf(const std::vector<PairSums>& pairs, size_t channel) {
    double product = 0.0;
    double square = 0.0;
    for (const PairSums& pair : pairs) {
      const double aa = pair.aa - std::norm(pair.normal[channel]);
      if (!(aa > 0.0)) continue;
      const Complex expected =
          (pair.ab - pair.Product(channel)) / aa * pair.normal[channel];
      const double weight = 1.0 / (pair.normal_misfit * pair.bb);
      product += weight * (std::conj(expected) * pair.value[channel]).real();
      square += weight * std::norm(expected);
    }
    return square > 0.0 ? product / square : 1.0;
  }

  Fault Scaled(const std::vector<PairSums>& pairs,
               const std::vector<std::string>& channels) const {
    Fault best;
    if (channels.size() < kFewestGainChannels) return best;
    for (size_t c = 0; c < channels.size(); ++c) {
      const double gain = GainOf(pairs, c);
      if (std::abs(gain - 1.0) < kLeastGainChange) continue;
      if (std::abs(gain) < 1e-6) continue;
      const double misfit = Mean(pairs, [c, gain](const PairSums& pair) {
        return pair.Misfit(
            pair.ab + (1.0 / gain - 1.0) * pair.Product(c),
            pair.bb + (1.0 / (gain * gain) - 1.0) * std::norm(pair.value[c]));
      });
      if (misfit >= best.misfit) continue;
      best = {{channels[c]},
              "gain",
              {"has " + FormatNumber(gain, 2) +
               " times the gain of the reference in every mode."},
              misfit};
    }
    return best;
  }

  Fault Late(const std::vector<PairSums>& pairs,
             const std::vector<std::string>& channels) const {
    double lowest = kInfinity;
    double highest = 0.0;
    for (const PairSums& pair : pairs) {
      lowest = std::min(lowest, pair.frequency_hz);
      highest = std::max(highest, pair.frequency_hz);
    }
    // Delays of up to a fourth of the longest period, in steps of 0.02 of the
    // shortest one.
    const int steps = static_cast<int>(
        std::min(1000.0, std::ceil(0.25 / lowest * highest / 0.02)));
    double least = kInfinity;
    double best_delay = 0.0;
    size_t best_channel = 0;
    std::vector<Complex> turns(pairs.size());
    for (int i = -steps; i <= steps; ++i) {
      if (i == 0) continue;
      const double delay = 0.25 / lowest * i / steps;
      for (size_t p = 0; p < pairs.size(); ++p) {
        turns[p] = std::polar(1.0, kTwoPi * pairs[p].frequency_hz * delay);
      }
      for (size_t c = 0; c < channels.size(); ++c) {
        // A late sensor keeps its gain.
        const double misfit = Mean(pairs, [&](const PairSums& pair) {
          const Complex turn = turns[static_cast<size_t>(&pair - &pairs[0])];
          return pair.Misfit(pair.ab + (turn - 1.0) * pair.Product(c), pair.bb);
        });
        if (misfit >= least) continue;
        least = misfit;
        best_delay = delay;
        best_channel = c;
      }
    }
    if (best_delay == 0.0) return {};
    return {
        {channels[best_channel]},
        "late",
        {std::string("is ") + (best_delay > 0.0 ? "late" : "early") + " by " +
         FormatNumber(std::abs(best_delay), 2) + " s against the reference."},
        least};
  }

  const TrackingOptions& options_;
  std::vector<Normal> normals_;
  double limit_ = kInfinity;
};

// Text that is equal for the same fault in several records.
std::string KeyOf(const Fault& fault) {
  return fault.kind + " " + Join(fault.channels, " ");
}

// Removes a channel from the shapes of a record.
void LeaveOut(const std::string& name, const std::string& fault,
              StoredRecord* record) {
  Eigen::Index place = 0;
  for (StoredChannel& channel : record->channels) {
    if (!channel.fault.empty()) continue;
    if (channel.name != name) {
      ++place;
      continue;
    }
    channel.fault = fault;
    for (StoredMode& mode : record->modes) {
      const Eigen::Index behind = mode.shape.size() - place - 1;
      if (behind < 0) continue;
      ComplexVector shape(mode.shape.size() - 1);
      shape << mode.shape.head(place), mode.shape.tail(behind);
      mode.shape = std::move(shape);
    }
    return;
  }
}

}  // namespace

std::vector<SensorChange> LeaveOutChangedSensors(
    const std::vector<bool>& is_reference, const TrackingOptions& options,
    std::vector<StoredRecord>* records) {
  std::vector<SensorChange> changes;
  const Comparison comparison(is_reference, options, *records);
  std::deque<Fault> recent;
  std::string last;  // kind and channels of the fault that is applied
  bool is_behind = false;
  for (size_t r = 0; r < records->size(); ++r) {
    if (is_reference[r]) {
      is_behind = true;
      continue;
    }
    if (!is_behind) continue;
    recent.push_back(comparison.Find((*records)[r]));
    if (recent.size() > kLast) recent.pop_front();
    std::map<std::string, int> counts;
    const Fault* found = nullptr;
    std::string what;
    for (const Fault& fault : recent) {
      if (fault.channels.empty()) continue;
      const std::string key = KeyOf(fault);
      if (++counts[key] < kAgreeing) continue;
      found = &fault;
      what = key;
    }
    if (found == nullptr) {
      last.clear();
      continue;
    }
    // The records before that agreed lose the channel too. Their modes would
    // begin histories.
    const bool is_new = what != last;
    for (size_t i = is_new ? 0 : recent.size() - 1; i < recent.size(); ++i) {
      const bool is_last = i + 1 == recent.size();
      if (!is_last && KeyOf(recent[i]) != what) continue;
      const size_t at = r + 1 + i - recent.size();
      const Fault& fault = KeyOf(recent[i]) == what ? recent[i] : *found;
      for (size_t c = 0; c < fault.channels.size(); ++c) {
        LeaveOut(fault.channels[c], fault.texts[c], &(*records)[at]);
      }
    }
    for (size_t c = 0; c < found->channels.size() && is_new; ++c) {
      changes.push_back(
          {static_cast<int>(r), found->channels[c], found->texts[c]});
    }
    last = what;
  }
  return changes;
}

}  // namespace pinode
