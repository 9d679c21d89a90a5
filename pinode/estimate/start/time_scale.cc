#include "pinode/estimate/start/time_scale.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {
namespace {

constexpr double kNothingSwings = 0.01;  // periods of the fastest mode
// Limits in periods of the slowest mode: of a whole record, and of the sampling
// step. With terms other than groups the limits are wider by the factor below.
constexpr double kShort = 0.1;
constexpr double kSparse = 2.0;
constexpr double kOtherTerms = 10.0;
// Periods of the slowest mode: at least in a record made to measure it, and at
// most between two samples.
constexpr double kLikely = 5.0;
constexpr double kLikelyApart = 0.4;

struct TimeUnit {
  const char* name;
  const char* in_words;
  double seconds;
};
constexpr TimeUnit kUnits[] = {
    {"us", "microseconds", 1e-6}, {"ms", "milliseconds", 1e-3},
    {"s", "seconds", 1.0},        {"min", "minutes", 60.0},
    {"h", "hours", 3600.0},       {"d", "days", 86400.0}};

bool HasOtherTerms(const StructuralDynamics& dynamics) {
  for (int t = 0; t < dynamics.num_terms(); ++t) {
    const TermKind kind = dynamics.term(t).kind();
    if (kind != TermKind::kGroups && kind != TermKind::kForceScale) return true;
  }
  return !dynamics.prescribed().empty();
}

bool AreMatricesToBeFound(const StructuralDynamics& dynamics) {
  const auto& groups = dynamics.groups();
  return std::any_of(groups.begin(), groups.end(), [](const GroupTerm& term) {
    return term.alpha.free && term.group.target != MatrixGroup::Target::kMass;
  });
}

// Returns the frequencies of the elastic modes in cycles per model time,
// ascending. Empty if one has a negative stiffness, or there are none.
std::vector<double> ElasticFrequencies(const StructuralModel& model) {
  UndampedModes modes;
  std::string unused;
  if (model.num_dofs() == 0 ||
      !ComputeUndampedModes(model.mass, model.stiffness, &modes, &unused) ||
      modes.eigenvalues[0] < 0.0) {
    return {};
  }
  std::vector<double> frequencies;
  for (const double value : modes.eigenvalues) {
    if (value > 0.0) frequencies.push_back(std::sqrt(value) / (2.0 * kPi));
  }
  return frequencies;
}

double DurationOf(const IdentificationRecord& record) {
  return record.sampling_step() * static_cast<double>(record.num_samples() - 1);
}

std::string TimeUnitOf(const IdentificationProblem& problem,
                       const IdentificationRecord& record) {
  return record.description.time_unit.empty() ? problem.description.units.time
                                              : record.description.time_unit;
}

// Returns the likely unit of a time of `periods`: the next larger one with at
// least `wanted` periods, or the next smaller one with at most that.
std::string LikelyUnit(const std::string& unit, double periods, double wanted) {
  const TimeUnit* const end = std::end(kUnits);
  const TimeUnit* const read =
      std::find_if(std::begin(kUnits), end,
                   [&unit](const TimeUnit& u) { return unit == u.name; });
  if (read == end) return "another unit";
  if (periods < wanted) {
    for (const TimeUnit* other = read + 1; other != end; ++other) {
      if (periods * other->seconds / read->seconds >= wanted) {
        return other->in_words;
      }
    }
  } else {
    for (const TimeUnit* other = read; other != std::begin(kUnits);) {
      --other;
      if (periods * other->seconds / read->seconds <= wanted) {
        return other->in_words;
      }
    }
  }
  return "another unit";
}

std::string ReadIn(const std::string& unit) {
  return "its times were read in " + unit + " (time_unit: s, ms or us)";
}

std::string Question(const std::string& unit, double periods, double wanted) {
  return ReadIn(unit) + ". Check whether they are in " +
         LikelyUnit(unit, periods, wanted) + ".";
}

std::string Mode(const char* which, double hertz) {
  return std::string(which) + " mode (" + FormatNumber(hertz, 4) + " Hz)";
}

}  // namespace

bool IsTimeScalePossible(const IdentificationProblem& problem,
                         std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  if (HasOtherTerms(dynamics) || !AreMatricesToBeFound(dynamics)) return true;
  const StructuralModel model = dynamics.HeldModel(dynamics.Parameters());
  // No DOF with all others held has a higher frequency than the fastest mode.
  const double least =
      std::sqrt(std::max(0.0, (model.stiffness.diagonal().array() /
                               model.mass.diagonal().array())
                                  .maxCoeff())) /
      (2.0 * kPi);
  double slowest = 0.0;
  double fastest = 0.0;
  for (const IdentificationRecord& record : problem.records) {
    const double duration = DurationOf(record);
    if (record.role != IdentificationRecord::Role::kTrain ||
        !problem.IsDriven(record) || !(duration * least < kNothingSwings)) {
      continue;
    }
    if (fastest == 0.0) {
      const std::vector<double> frequencies = ElasticFrequencies(model);
      if (frequencies.empty()) return true;
      slowest = frequencies.front();
      fastest = frequencies.back();
    }
    if (!(duration * fastest < kNothingSwings)) continue;
    const std::string unit = TimeUnitOf(problem, record);
    const double hertz = problem.description.HzPerModelFrequency() * fastest;
    *error = "record '" + record.name + "' lasts " +
             FormatNumber(duration * fastest, 2) + " periods of the model's " +
             Mode("fastest", hertz) +
             ", too few for any vibration: " + ReadIn(unit) +
             ", but are probably in " +
             LikelyUnit(unit, duration * slowest, kLikely);
    return false;
  }
  return true;
}

std::vector<std::string> TimeScaleRemarks(
    const IdentificationProblem& problem) {
  std::vector<std::string> remarks;
  const bool any_driven = std::any_of(
      problem.records.begin(), problem.records.end(),
      [&problem](const auto& record) { return problem.IsDriven(record); });
  if (!any_driven) return remarks;
  const StructuralDynamics& dynamics = *problem.dynamics;
  const std::vector<double> frequencies =
      ElasticFrequencies(dynamics.HeldModel(dynamics.Parameters()));
  if (frequencies.empty()) return remarks;
  const double slowest = frequencies.front();
  const double further = HasOtherTerms(dynamics) ? kOtherTerms : 1.0;
  const std::string mode = Mode(
      "slowest elastic", problem.description.HzPerModelFrequency() * slowest);
  for (const IdentificationRecord& record : problem.records) {
    if (!problem.IsDriven(record)) continue;
    const double lasts = DurationOf(record) * slowest;
    const double apart = record.sampling_step() * slowest;
    const std::string unit = TimeUnitOf(problem, record);
    if (lasts < kShort / further) {
      remarks.push_back("Record '" + record.name + "' lasts " +
                        FormatNumber(lasts, 2) + " periods of the model's " +
                        mode + ": " + Question(unit, lasts, kLikely));
    } else if (apart > kSparse * further) {
      remarks.push_back("Record '" + record.name + "': one sampling step is " +
                        FormatNumber(apart, 2) + " periods of the model's " +
                        mode + ". This is right for a slow test only; " +
                        Question(unit, apart, kLikelyApart));
    }
  }
  return remarks;
}

}  // namespace pinode
