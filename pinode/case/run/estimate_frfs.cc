#include "pinode/case/run/estimate_frfs.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/record/frf/frf_files.h"

namespace pinode {
namespace {

using Eigen::Index;

// Power of the force relative to its largest below which a line is noise: 40
// dB, a hundredth of the force.
constexpr double kWeakForce = 1e-4;
// Lines that the window and the removed mean of a block disturb. Periods have
// neither.
constexpr double kDisturbedLines = 3.0;
// Coherence that a clean test exceeds outside of its antiresonances.
constexpr double kLowCoherence = 0.8;

// Records with the same channels and forces.
struct FrfGroup {
  std::vector<size_t> records;
};

bool HaveSameSetup(const ModesCase& c, size_t a, size_t b) {
  const std::vector<ResponseChannel>& one = c.records[a].channels;
  const std::vector<ResponseChannel>& two = c.records[b].channels;
  if (c.loads[a] != c.loads[b] || one.size() != two.size()) return false;
  for (size_t i = 0; i < one.size(); ++i) {
    if (one[i].name != two[i].name || one[i].derivative != two[i].derivative) {
      return false;
    }
  }
  return true;
}

class CaseFrfEstimation {
 public:
  CaseFrfEstimation(const ModesCase& c, EstimatedFrfs* result,
                    std::string* error)
      : c_(c), result_(*result), error_(error) {}

  bool Run() {
    std::vector<FrfGroup> groups;
    for (size_t r = 0; r < c_.records.size(); ++r) {
      if (!Check(r)) return false;
      const auto same =
          std::find_if(groups.begin(), groups.end(), [&](const FrfGroup& g) {
            return HaveSameSetup(c_, g.records[0], r);
          });
      if (same == groups.end()) {
        groups.push_back({{r}});
      } else {
        same->records.push_back(r);
      }
    }
    for (const FrfGroup& group : groups) {
      if (!Estimate(group)) return false;
    }
    std::vector<std::string> remarks = std::move(result_.all.remarks);
    if (!AssembleFrequencyResponses(single_, &result_.all, error_)) {
      *error_ = c_.path + ": record " + *error_;
      return false;
    }
    result_.all.name = c_.records[0].name;
    result_.all.remarks = std::move(remarks);
    if (!enough_) result_.all.variances.resize(0, 0);
    SayCoherence();
    return true;
  }

 private:
  bool Fail(size_t r, const std::string& message) {
    const auto line = c_.record_lines.find(c_.records[r].name);
    return CaseErrors(c_.path, error_)
        .Fail(line == c_.record_lines.end() ? 0 : line->second, message);
  }

  bool Check(size_t r) {
    const ResponseRecord& record = c_.records[r];
    if (record.inputs.rows() == 0) {
      return Fail(r,
                  "frequency response functions need a measured force, "
                  "expected [[record.force]], or no [modes.frf]");
    }
    for (const std::string& load : c_.loads[r]) {
      if (!load.empty()) continue;
      return Fail(r,
                  "a motion of the ground or of an actuator is no force; leave "
                  "[modes.frf] out, and its modes are found from the record");
    }
    for (const ResponseChannel& channel : record.channels) {
      if (channel.derivative == record.channels[0].derivative) continue;
      return Fail(r, "channels '" + record.channels[0].name + "' and '" +
                         channel.name +
                         "' differ in their quantity, expected one for "
                         "frequency response functions");
    }
    return true;
  }

  bool Estimate(const FrfGroup& group) {
    const size_t first = group.records[0];
    const ResponseRecord& own = c_.records[first];
    std::vector<ForcedRecord> records;
    for (const size_t r : group.records) {
      const ResponseRecord& record = c_.records[r];
      records.push_back(
          {record.name, record.sampling_step, record.inputs, record.samples});
    }
    FrfEstimateOptions options = c_.frf->options;
    FrfEstimate estimate;
    std::string message;
    if ((c_.frf->block > 0.0 &&
         !FindFrfBlock(records, c_.frf->block, &options, &message)) ||
        !EstimateFrfs(records, options, &estimate, &message)) {
      return Fail(first, "[modes.frf]: " + message);
    }
    if (c_.frf->has_overlap && estimate.excitation != FrfExcitation::kRandom) {
      return Fail(first,
                  "[modes.frf]: overlap is for blocks of a random force; leave "
                  "it out for blows and periods");
    }
    if (estimate.frequencies_hz.size() < 2) {
      return Fail(first,
                  "[modes.frf]: the force acts at fewer than two lines; set a "
                  "longer block or another force");
    }
    Say(own.name, estimate);
    TakeBand(estimate);
    enough_ = enough_ && estimate.coherence.rows() > 0 &&
              estimate.num_averages >= kFewestAveragesForWeights;
    std::vector<std::string> responses;
    for (const ResponseChannel& channel : own.channels) {
      responses.push_back(channel.name);
    }
    for (FrequencyResponse& one :
         SingleFrfs(estimate, "'" + own.name + "'", responses, c_.loads[first],
                    own.channels[0].derivative)) {
      single_.push_back(std::move(one));
    }
    return true;
  }

  void Say(const std::string& name, const FrfEstimate& estimate) {
    std::vector<std::string>& remarks = result_.all.remarks;
    const std::string begin = "Record '" + name + "': ";
    const std::string blocks = std::to_string(estimate.num_blocks);
    const char* const kind =
        estimate.excitation == FrfExcitation::kBlows      ? " blows"
        : estimate.excitation == FrfExcitation::kPeriodic ? " periods"
                                                          : " blocks";
    remarks.push_back(begin + "frequency response functions of " + blocks +
                      kind + " of " + FormatNumber(estimate.block_seconds, 4) +
                      " s" +
                      (estimate.excitation == FrfExcitation::kRandom
                           ? ", as " + FormatNumber(estimate.num_averages, 3) +
                                 " independent ones."
                           : "."));
    for (const std::string& remark : estimate.remarks) {
      remarks.push_back(begin + remark);
    }
  }

  // Narrows the band to the lines at which the forces of all groups act.
  void TakeBand(const FrfEstimate& estimate) {
    const auto take_shorter = [](double value, double* shortest) {
      if (value > 0.0 && (*shortest == 0.0 || value < *shortest)) {
        *shortest = value;
      }
    };
    if (estimate.excitation == FrfExcitation::kBlows) {
      take_shorter(estimate.block_seconds, &result_.block_seconds);
    }
    take_shorter(estimate.shortest_rest, &result_.shortest_rest);
    const Vector& lines = estimate.frequencies_hz;
    const double distance = 1.0 / estimate.block_seconds;
    result_.line_distance_hz = std::max(result_.line_distance_hz, distance);
    result_.has_leakage =
        result_.has_leakage || estimate.excitation == FrfExcitation::kRandom;
    Index peak = 0;
    estimate.force_power.maxCoeff(&peak);
    Index first = peak;
    while (first > 0 && estimate.force_power[first - 1] > kWeakForce) --first;
    double lowest = lines[first];
    if (estimate.excitation != FrfExcitation::kPeriodic) {
      lowest = std::max(lowest, kDisturbedLines * distance);
    }
    result_.lowest_hz = std::max(result_.lowest_hz, lowest);
    Index last = peak;
    while (last + 1 < lines.size() &&
           estimate.force_power[last + 1] > kWeakForce) {
      ++last;
    }
    const double highest = lines[last];
    result_.highest_hz = result_.highest_hz > 0.0
                             ? std::min(result_.highest_hz, highest)
                             : highest;
  }

  void SayCoherence() {
    const Matrix& coherence = result_.all.coherence;
    if (coherence.rows() == 0) return;
    double all = 0.0;
    double worst = 2.0;
    std::string pair;
    for (Index p = 0; p < coherence.cols(); ++p) {
      std::vector<double> in_band;
      for (Index k = 0; k < coherence.rows(); ++k) {
        const double hz = result_.all.frequencies_hz[k];
        if (hz < result_.lowest_hz || hz > result_.highest_hz) continue;
        in_band.push_back(coherence(k, p));
      }
      if (in_band.empty()) continue;
      const double middle = Median(in_band);
      all += middle / static_cast<double>(coherence.cols());
      if (middle >= worst) continue;
      worst = middle;
      const Index responses = result_.all.num_responses();
      pair = result_.all.responses[static_cast<size_t>(p % responses)] + "/" +
             result_.all.references[static_cast<size_t>(p / responses)];
    }
    if (pair.empty()) return;
    std::string text =
        "Median coherence from " + FormatNumber(result_.lowest_hz, 3) + " to " +
        FormatNumber(result_.highest_hz, 4) + " Hz: " + FormatNumber(all, 3);
    if (coherence.cols() > 1) {
      text += " on average, " + FormatNumber(worst, 3) + " at " + pair;
    }
    text += worst < kLowCoherence
                ? ". Below 0.8, noise, another load or a nonlinear structure "
                  "is in the responses."
                : ".";
    result_.all.remarks.push_back(text);
  }

  const ModesCase& c_;
  EstimatedFrfs& result_;
  std::string* error_;
  std::vector<FrequencyResponse> single_;
  bool enough_ = true;
};

// Returns the functions at the lines of a band alone.
FrequencyResponses LinesBetween(const FrequencyResponses& all, double lowest_hz,
                                double highest_hz) {
  std::vector<Index> lines;
  for (Index k = 0; k < all.num_lines(); ++k) {
    const double hz = all.frequencies_hz[k];
    if (hz >= lowest_hz && hz <= highest_hz) lines.push_back(k);
  }
  FrequencyResponses result = all;
  result.frequencies_hz = all.frequencies_hz(lines);
  result.values = all.values(lines, Eigen::all);
  if (all.variances.rows() > 0) {
    result.variances = all.variances(lines, Eigen::all);
  }
  if (all.coherence.rows() > 0) {
    result.coherence = all.coherence(lines, Eigen::all);
  }
  return result;
}

}  // namespace

bool EstimateFrfsOfCase(const ModesCase& c, EstimatedFrfs* result,
                        std::string* error) {
  *result = EstimatedFrfs();
  return CaseFrfEstimation(c, result, error).Run();
}

std::string EstimatedFrfsAsFile(const EstimatedFrfs& estimated,
                                const ModesCase& c) {
  const auto within = [](double given, double found, bool lower) {
    if (!(given > 0.0)) return found;
    return lower ? std::min(given, found) : std::max(given, found);
  };
  FrequencyResponses all = LinesBetween(
      estimated.all,
      within(c.options.lowest_hz, estimated.lowest_hz, /*lower=*/true),
      within(c.options.highest_hz, estimated.highest_hz, /*lower=*/false));
  if (all.variances.rows() == 0) all.coherence.resize(0, 0);
  const Dimension dimensions[] = {Dimension::kLength, Dimension::kVelocity,
                                  Dimension::kAcceleration};
  return FormatFrfFile(all, UnitName(dimensions[all.derivative], c.units),
                       UnitName(Dimension::kForce, c.units));
}

}  // namespace pinode
