#include "pinode/record/frf/blows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

using Eigen::Index;

// Forces as shares of the largest one: of a pulse, and of a blow.
constexpr double kPulse = 0.02;
constexpr double kBlow = 0.1;
// Deviations of the noise that a pulse must exceed.
constexpr double kNoise = 8.0;
// Share of a blow's own peak from which another pulse is a second hit. The
// ringing of an anti-aliasing filter belongs to the blow: it is within three
// widths of the pulse.
constexpr double kSecondHit = 0.05;
constexpr Index kRinging = 3;
// Share of the samples that blows may fill.
constexpr double kMostInPulses = 0.1;
// Distances below this share of the typical one are second hits.
constexpr double kShortDistance = 0.3;
// Equal samples at the extreme value, and the least step beside them in
// multiples of the resolution, that a force within the range does not show.
constexpr Index kFlatSamples = 3;
constexpr double kPlateauSteps = 2.5;
// Steps of the resolution in a force from which two blows do not have the same
// peak by chance.
constexpr double kFineSteps = 500.0;
// Vibration left at the end of a block, as a share of its beginning, from which
// the cut raises the damping.
constexpr double kMuchLeft = 0.05;

struct ForcePulse {
  Index begin = 0;
  Index end = 0;      // the sample after it
  double peak = 0.0;  // share of the record's largest force
};

// Sizes of the forces without their offsets: the largest over the references,
// each relative to `largest`.
Vector SizesOf(const ForcedRecord& record, const Vector& largest) {
  Vector sizes = Vector::Zero(record.forces.cols());
  for (Index j = 0; j < record.forces.rows(); ++j) {
    if (!(largest[j] > 0.0)) continue;
    const Vector force = record.forces.row(j);
    const double offset = Median({force.begin(), force.end()});
    sizes =
        sizes.cwiseMax((force.array() - offset).abs().matrix() / largest[j]);
  }
  return sizes;
}

Vector LargestForces(const std::vector<ForcedRecord>& records) {
  Vector largest = Vector::Zero(records[0].forces.rows());
  for (const ForcedRecord& record : records) {
    for (Index j = 0; j < largest.size(); ++j) {
      const Vector force = record.forces.row(j);
      const double offset = Median({force.begin(), force.end()});
      largest[j] =
          std::max(largest[j], (force.array() - offset).abs().maxCoeff());
    }
  }
  return largest;
}

// Finds pulses above the noise. Runs that are parted by less than the width of
// the first are one pulse: a force that crosses zero, or the ringing of a
// filter.
std::vector<ForcePulse> FindPulses(const Vector& sizes) {
  const double noise = 1.4826 * Median({sizes.begin(), sizes.end()});
  const double trigger = std::max(kPulse, kNoise * noise);
  std::vector<ForcePulse> pulses;
  for (Index k = 0; k < sizes.size(); ++k) {
    if (!(sizes[k] > trigger)) continue;
    if (!pulses.empty() &&
        k - pulses.back().end <=
            std::max<Index>(2, (pulses.back().end - pulses.back().begin) / 2)) {
      pulses.back().end = k + 1;
    } else {
      pulses.push_back({k, k + 1, 0.0});
    }
    pulses.back().peak = std::max(pulses.back().peak, sizes[k]);
  }
  return pulses;
}

// Smallest step between neighbouring samples.
double ResolutionOf(const Vector& values) {
  double smallest = kInfinity;
  for (Index k = 1; k < values.size(); ++k) {
    const double step = std::abs(values[k] - values[k - 1]);
    if (step > 0.0) smallest = std::min(smallest, step);
  }
  return smallest;
}

// Returns true if the extreme value is a plateau with steep sides.
bool IsCutOff(const Vector& values, double resolution) {
  for (const double sign : {1.0, -1.0}) {
    Index at = 0;
    const double extreme = sign * (sign * values).maxCoeff(&at);
    Index end = at;
    while (end < values.size() && values[end] == extreme) ++end;
    if (end - at < kFlatSamples || at == 0 || end == values.size()) continue;
    const double before = std::abs(extreme - values[at - 1]);
    const double after = std::abs(extreme - values[end]);
    if (std::min(before, after) > kPlateauSteps * resolution) return true;
  }
  return false;
}

// Returns true if the pulse reaches `limit` to the last digit.
bool Reaches(const Vector& force, const ForcePulse& pulse, double limit) {
  const Vector part = force.segment(pulse.begin, pulse.end - pulse.begin);
  return (part.array() == limit).any();
}

// Returns true if pulses of different impulses have the same peak `limit`.
// Blows of a simulation may be all alike.
bool IsLimit(const Vector& force, const std::vector<ForcePulse>& pulses,
             double limit) {
  double least = kInfinity;
  double largest = -kInfinity;
  for (const ForcePulse& pulse : pulses) {
    if (!Reaches(force, pulse, limit)) continue;
    const double impulse =
        force.segment(pulse.begin, pulse.end - pulse.begin).sum();
    least = std::min(least, impulse);
    largest = std::max(largest, impulse);
  }
  return largest - least > 1e-6 * std::abs(largest);
}

// Root mean square of the responses, each relative to its own, over `count`
// samples.
double Motion(const ForcedRecord& record, const Vector& sizes, Index first,
              Index count) {
  const Matrix part = record.responses.middleCols(first, count);
  const Vector means = record.responses.rowwise().mean();
  double sum = 0.0;
  for (Index o = 0; o < part.rows(); ++o) {
    sum += (part.row(o).array() - means[o]).square().mean() /
           (sizes[o] * sizes[o]);
  }
  return std::sqrt(sum / static_cast<double>(part.rows()));
}

std::string BlowsText(int count) {
  return std::to_string(count) +
         (count == 1 ? " blow was left out" : " blows were left out");
}

class BlowFinder {
 public:
  BlowFinder(const std::vector<ForcedRecord>& records, Index block_samples,
             double decay_per_sample, BlowSearch* search)
      : records_(records),
        is_given_(block_samples > 0),
        decay_per_sample_(decay_per_sample),
        search_(*search) {
    const Vector largest = LargestForces(records);
    for (const ForcedRecord& record : records) {
      pulses_.push_back(FindPulses(SizesOf(record, largest)));
    }
    search_.block_samples =
        is_given_ ? block_samples : FastLength(ChooseLength());
  }

  bool Find(std::string* error) {
    if (search_.block_samples < kFewestSamples) {
      if (is_given_) {
        *error = "block has " + std::to_string(search_.block_samples) +
                 " samples, expected at least " +
                 std::to_string(kFewestSamples) + " for blows of a hammer";
        return false;
      }
      *error =
          "no blow of a hammer was found, or the blows follow each other at "
          "once; set excitation = \"random\" for other forces";
      return false;
    }
    for (size_t r = 0; r < records_.size(); ++r) TakeRecord(r);
    Say();
    if (!search_.blocks.empty()) return true;
    *error = "no blow is left: " + Join(search_.remarks, " ");
    return false;
  }

 private:
  static constexpr Index kFewestSamples = 32;

  // Samples before a blow, for the rise of its force.
  static Index Before(const ForcePulse& pulse) {
    return std::max<Index>(4, pulse.end - pulse.begin);
  }

  Index ChooseLength() const {
    std::vector<double> distances;
    Index rest = 0;
    for (size_t r = 0; r < records_.size(); ++r) {
      Index last_begin = -1;
      Index last_first = 0;
      for (const ForcePulse& pulse : pulses_[r]) {
        if (pulse.peak < kBlow) continue;
        if (last_begin >= 0) {
          distances.push_back(static_cast<double>(pulse.begin - last_begin));
        }
        last_begin = pulse.begin;
        last_first = std::max<Index>(0, pulse.begin - Before(pulse));
      }
      if (last_begin < 0) continue;
      const Index own = records_[r].forces.cols() - last_first;
      rest = rest == 0 ? own : std::min(rest, own);
    }
    if (distances.empty()) return rest;
    std::sort(distances.begin(), distances.end());
    const double typical = distances[distances.size() * 9 / 10];
    const auto least = std::find_if(
        distances.begin(), distances.end(),
        [&](double distance) { return distance >= kShortDistance * typical; });
    const Index length = static_cast<Index>(*least) - 1;
    // Records with one blow each and one that the hammer hits twice.
    return distances.size() < records_.size() ? std::max(length, rest) : length;
  }

  void TakeRecord(size_t r) {
    const ForcedRecord& record = records_[r];
    std::vector<double> steps, force_steps;
    for (Index o = 0; o < record.responses.rows(); ++o) {
      steps.push_back(ResolutionOf(record.responses.row(o)));
    }
    for (Index j = 0; j < record.forces.rows(); ++j) {
      force_steps.push_back(ResolutionOf(record.forces.row(j)));
    }
    const std::vector<double> limits = LimitsOf(r, force_steps);
    Index free_from = 0;
    for (size_t p = 0; p < pulses_[r].size(); ++p) {
      const ForcePulse& pulse = pulses_[r][p];
      const Index first = pulse.begin - Before(pulse);
      if (pulse.peak < kBlow || pulse.begin < free_from) continue;
      if (first < 0 || first + search_.block_samples > record.forces.cols()) {
        ++incomplete_;
        continue;
      }
      free_from = first + search_.block_samples;
      if (pulse.end + Tenth() > free_from) {
        ++unfinished_;
        continue;
      }
      const auto is_cut_off = [&](const Matrix& rows,
                                  const std::vector<double>& resolutions) {
        for (Index i = 0; i < rows.rows(); ++i) {
          const Vector values =
              rows.row(i).segment(first, search_.block_samples);
          if (IsCutOff(values, resolutions[static_cast<size_t>(i)])) {
            return true;
          }
        }
        return false;
      };
      if (IsHitTwice(r, p, free_from)) {
        ++hit_twice_;
      } else if (IsAtLimit(r, pulse, limits) ||
                 is_cut_off(record.forces, force_steps) ||
                 is_cut_off(record.responses, steps)) {
        ++cut_off_;
      } else {
        search_.blocks.push_back({r, first, pulse.end - first});
        Watch(record, first, pulse.end);
        NoteRest(r, p);
      }
    }
  }

  // Returns the extreme values of the forces that several blows share, two for
  // each force: their range. NaN: no limit is known.
  std::vector<double> LimitsOf(size_t r,
                               const std::vector<double>& steps) const {
    std::vector<double> limits;
    for (Index j = 0; j < records_[r].forces.rows(); ++j) {
      const Vector force = records_[r].forces.row(j);
      for (const double limit : {force.maxCoeff(), force.minCoeff()}) {
        const bool is_fine =
            std::abs(limit) > kFineSteps * steps[static_cast<size_t>(j)];
        limits.push_back(is_fine && IsLimit(force, pulses_[r], limit) ? limit
                                                                      : kNaN);
      }
    }
    return limits;
  }

  bool IsAtLimit(size_t r, const ForcePulse& pulse,
                 const std::vector<double>& limits) const {
    for (size_t i = 0; i < limits.size(); ++i) {
      const Vector force = records_[r].forces.row(static_cast<Index>(i / 2));
      if (Reaches(force, pulse, limits[i])) return true;
    }
    return false;
  }

  bool IsHitTwice(size_t r, size_t p, Index end) const {
    const ForcePulse& own = pulses_[r][p];
    const Index ringing = own.end + kRinging * (own.end - own.begin);
    for (size_t i = p + 1; i < pulses_[r].size(); ++i) {
      const ForcePulse& other = pulses_[r][i];
      if (other.begin >= end) break;
      // Within the ringing, only what is a blow of its own counts.
      const double least = other.begin < ringing ? 2.0 * kBlow : kSecondHit;
      if (other.peak >= least * own.peak) return true;
    }
    return false;
  }

  // Notes the rest before the blow. Blows that are left out end it too.
  void NoteRest(size_t r, size_t p) {
    for (size_t i = p; i-- > 0;) {
      if (pulses_[r][i].peak < kBlow) continue;
      const Index rest = pulses_[r][p].begin - pulses_[r][i].begin;
      search_.shortest_rest = search_.shortest_rest == 0
                                  ? rest
                                  : std::min(search_.shortest_rest, rest);
      return;
    }
  }

  Index Tenth() const { return search_.block_samples / 10; }

  // Notes how much of the vibration is left at the end of a block.
  void Watch(const ForcedRecord& record, Index first, Index begin) {
    const Index tenth = Tenth();
    Vector sizes(record.responses.rows());
    for (Index o = 0; o < sizes.size(); ++o) {
      sizes[o] =
          std::max(1e-300, StandardDeviationOfPresent(record.responses.row(o)));
    }
    const double start = Motion(record, sizes, begin, tenth);
    const double end =
        Motion(record, sizes, first + search_.block_samples - tenth, tenth);
    if (!(start > 0.0)) return;
    left_.push_back(end / start *
                    std::exp(-decay_per_sample_ *
                             static_cast<double>(search_.block_samples)));
  }

  void Say() {
    if (hit_twice_ > 0) {
      search_.remarks.push_back(BlowsText(hit_twice_) +
                                ": the hammer hit again within the block.");
    }
    if (cut_off_ > 0) {
      search_.remarks.push_back(
          BlowsText(cut_off_) +
          ": the force or a response is cut off at its range. Measure again "
          "with a larger range.");
    }
    if (incomplete_ > 0) {
      search_.remarks.push_back(BlowsText(incomplete_) +
                                ": the record does not hold the whole block.");
    }
    if (unfinished_ > 0) {
      search_.remarks.push_back(
          BlowsText(unfinished_) +
          ": the block ends before the blow does. Set a longer block.");
    }
    const double left = left_.empty() ? 0.0 : Median(left_);
    if (left > kMuchLeft) {
      search_.remarks.push_back(
          "At the end of the blocks, " + FormatNumber(100.0 * left, 2) +
          " % of the motion is left. If it is vibration and not noise, it is "
          "in "
          "the next block: wait longer between the blows. If the structure "
          "rests before each blow, set exponential_window or a longer block.");
    }
  }

  const std::vector<ForcedRecord>& records_;
  const bool is_given_;  // the length of the blocks
  const double decay_per_sample_;
  BlowSearch& search_;
  std::vector<std::vector<ForcePulse>> pulses_;
  std::vector<double> left_;
  int hit_twice_ = 0, cut_off_ = 0, incomplete_ = 0, unfinished_ = 0;
};

}  // namespace

bool HasBlows(const std::vector<ForcedRecord>& records) {
  const Vector largest = LargestForces(records);
  Index in_pulses = 0;
  Index samples = 0;
  for (const ForcedRecord& record : records) {
    for (const ForcePulse& pulse : FindPulses(SizesOf(record, largest))) {
      in_pulses += pulse.end - pulse.begin;
    }
    samples += record.forces.cols();
  }
  return in_pulses > 0 && static_cast<double>(in_pulses) <
                              kMostInPulses * static_cast<double>(samples);
}

bool FindBlows(const std::vector<ForcedRecord>& records,
               Eigen::Index block_samples, double decay_per_sample,
               BlowSearch* search, std::string* error) {
  *search = BlowSearch();
  return BlowFinder(records, block_samples, decay_per_sample, search)
      .Find(error);
}

Eigen::Index FastLength(Eigen::Index samples) {
  Index best = std::min<Index>(1, samples);
  for (Index fives = 1; fives <= samples; fives *= 5) {
    for (Index threes = fives; threes <= samples; threes *= 3) {
      Index twos = threes;
      while (twos <= samples / 2) twos *= 2;
      best = std::max(best, twos);
    }
  }
  return best;
}

}  // namespace pinode
