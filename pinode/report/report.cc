#include "pinode/report/report.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <memory>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/report/number_text.h"
#include "pinode/study/problem/prior_comparison.h"

namespace pinode {
namespace {

using Role = IdentificationRecord::Role;

std::string Quoted(const std::string& name) { return "'" + name + "'"; }

std::string PercentOf(double fraction) {
  return ReadableNumber(100.0 * fraction, 3) + " %";
}

const IdentificationRecord& RecordAt(const ReportInput& input, int record) {
  CHECK(input.problem != nullptr) << "a report needs the problem";
  return input.problem->records.at(static_cast<size_t>(record));
}

// An error of a free run in words.
const char* HowWell(double nrmse) {
  if (nrmse <= 0.02) return "very well";
  if (nrmse <= 0.05) return "well";
  if (nrmse <= 0.15) return "fairly well";
  if (nrmse <= 0.4) return "roughly";
  return "poorly";
}

// "'r' well, with an error of 4 % (initial model: 20 %; noise explains 30 % of
// the remaining error)".
std::string Prediction(const RecordScore& record) {
  const double noise = NoiseShareOf(record);
  std::string text = Quoted(record.name) + " " + HowWell(record.nrmse) +
                     ", with an error of " + PercentOf(record.nrmse) +
                     " (initial model: " + PercentOf(record.prior_nrmse);
  if (std::isfinite(noise)) {
    text += "; noise explains " + ReadableNumber(100.0 * noise, 2) +
            " % of the remaining error";
  }
  return text + ")";
}

// How well the measured modes are met, after a blank; empty without any.
std::string ModeSentence(const IdentificationSummary& summary) {
  if (summary.modes.empty()) return "";
  double initial = 0.0, updated = 0.0;
  double least_mac = std::numeric_limits<double>::infinity();
  for (const ModeScore& mode : summary.modes) {
    const auto error = [&mode](const ModeMatch& match) {
      return std::abs(match.frequency / mode.frequency - 1.0);
    };
    initial = std::max(initial, error(mode.initial));
    updated = std::max(updated, error(mode.updated));
    if (std::isfinite(mode.updated.mac)) {
      least_mac = std::min(least_mac, mode.updated.mac);
    }
  }
  std::string sentence = " The model meets the measured frequencies within " +
                         PercentOf(updated) +
                         " (initial model: " + PercentOf(initial) + ")";
  if (std::isfinite(least_mac)) {
    sentence += " and the shapes with a MAC of at least " +
                ReadableNumber(least_mac, 4);
  }
  return sentence + ".";
}

}  // namespace

std::string WhatIsMissed(const IdentificationSummary& summary) {
  double most = 0.0;
  for (const RecordScore& record : summary.records) {
    if (record.role != Role::kTrain) continue;
    const double missed = StructuredError(record);
    if (missed > limits::kMuchUnexplained ||
        (missed > limits::kNotedUnexplained && NoiseShareOf(record) < 0.5)) {
      most = std::max(most, missed);
    }
  }
  if (most == 0.0) return "";
  return "Of the measured motion " + PercentOf(most) +
         " is unexplained and too large to be noise. The intervals assume a "
         "complete model, and this one is not. Find the cause first.";
}

namespace {

std::string Capitalized(std::string text) {
  if (!text.empty()) {
    text[0] =
        static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  }
  return text;
}

// "Usable with care: <finding>. <Advice>. "; empty for a good result.
std::string Cares(const Verdict& verdict) {
  if (verdict.grade() == Grade::kGood) return "";
  std::string text = std::string(GradeTitle(verdict.grade())) + ": ";
  bool first = true;
  for (const Finding& finding : verdict.findings()) {
    text += (first ? finding.what : Capitalized(finding.what)) + ". ";
    if (!finding.advice.empty()) text += Capitalized(finding.advice) + ". ";
    first = false;
  }
  return text;
}

}  // namespace

std::string VerdictSentence(const ReportInput& input) {
  CHECK(input.summary != nullptr) << "a report needs the summary";
  const IdentificationSummary& summary = *input.summary;
  const std::string cares = Cares(summary.verdict);
  if (!summary.usable()) return cares.substr(0, cares.size() - 1);
  const std::string usable = cares.empty() ? "Good. " : cares;
  std::vector<std::string> holdouts;
  const RecordScore* worst_training = nullptr;
  for (const RecordScore& record : summary.records) {
    if (record.role == Role::kHoldout) {
      holdouts.push_back(Prediction(record));
    } else if (worst_training == nullptr ||
               record.nrmse > worst_training->nrmse) {
      worst_training = &record;
    }
  }
  // A finding says it already.
  std::string missed = cares.empty() ? WhatIsMissed(summary) : "";
  if (!missed.empty()) missed.insert(0, " ");
  if (!holdouts.empty()) {
    return usable + "The updated model predicts the hold-out " +
           (holdouts.size() == 1 ? "record " : "records ") +
           Join(holdouts, ", ") + "." + missed + ModeSentence(summary);
  }
  std::string verdict =
      cares.empty() ? "Good, but untested" : cares + "It is untested";
  if (worst_training == nullptr && !summary.ambient.empty()) {
    std::vector<std::string> records;
    double least = 1.0;
    for (const AmbientScore& score : summary.ambient) {
      least = std::min(least, score.LeastProbability());
      records.push_back("'" + score.name + "' (probability " +
                        ReadableNumber(score.LeastProbability(), 2) + ")");
    }
    return usable + "The spectra of " +
           std::string(records.size() == 1 ? "ambient record "
                                           : "the ambient records ") +
           Join(records, ", ") +
           (least < kDoubtfulAmbientProbability
                ? " differ from those of the model by a little more than "
                  "chance. The intervals allow for it."
                : " differ from those of the model by no more than chance.") +
           ModeSentence(summary);
  }
  if (worst_training == nullptr && !summary.frfs.empty() && cares.empty()) {
    double worst = 0.0;
    for (const FrfScore& score : summary.frfs) {
      worst = std::max(worst, score.WorstError());
    }
    return usable +
           "The updated model follows the frequency response functions "
           "within " +
           ReadableNumber(100.0 * worst, 2) + " %, and the rest is noise." +
           ModeSentence(summary);
  }
  if (worst_training != nullptr) {
    verdict += ": the updated model follows the training record " +
               Prediction(*worst_training) + "." + missed;
  } else {
    verdict += ".";
  }
  return verdict + ModeSentence(summary) +
         " No record was held out, so the model is not tested on unseen data.";
}

std::string PinodeVersion() { return PINODE_VERSION; }

ReportInput MakeReportInput(const IdentificationProblem& problem,
                            const IdentificationSummary& summary,
                            const IdentifiedModel& model,
                            const ReportOrigin& origin) {
  ReportInput input;
  input.problem = &problem;
  input.summary = &summary;
  input.model = &model;
  input.prior = CompareWithPrior(problem, model);
  const auto runs = std::make_shared<PriorRuns>(problem, model);
  input.run_prior = [runs](int record, const std::vector<int>& channels) {
    return runs->Run(record, channels);
  };
  input.origin = origin;
  input.version = PinodeVersion();
  return input;
}

std::string ChannelPlace(const ReportInput& input, int record, int channel) {
  return LocationText(RecordAt(input, record)
                          .channels.at(static_cast<size_t>(channel))
                          .observation.weights,
                      input.problem->dynamics->model().dof_names);
}

std::string ChannelUnit(const ReportInput& input, int record, int channel) {
  const MeasuredChannel& measured =
      RecordAt(input, record).channels.at(static_cast<size_t>(channel));
  // A combination may carry a length, which its quantity does not say.
  const UnitSystem& units = input.problem->description.units;
  std::string unit = input.problem->UnitOf(measured);
  if (measured.description.factor == 1.0) return unit;
  double unused = 0.0;
  std::string error;
  return UnitName(UnitFactor(unit, Dimension::kVoltage, units, &unused, &error)
                      ? Dimension::kVoltage
                      : DimensionOf(measured.observation.quantity),
                  units);
}

double NoiseShare(const ReportInput& input, int record, int channel) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const size_t r = static_cast<size_t>(record);
  const size_t c = static_cast<size_t>(channel);
  if (r >= input.summary->records.size() ||
      c >= input.summary->records[r].channels.size()) {
    return nan;
  }
  double count = 0.0, mean = 0.0, squares = 0.0;
  for (double y : RecordAt(input, record).channels.at(c).values) {
    if (!std::isfinite(y)) continue;
    // Welford's update.
    count += 1.0;
    const double difference = y - mean;
    mean += difference / count;
    squares += difference * (y - mean);
  }
  const double sigma = input.summary->records[r].channels[c].sigma;
  if (!(squares > 0.0) || !(sigma > 0.0)) return nan;
  return sigma / std::sqrt(squares / count);
}

std::vector<size_t> ShownChanges(const DamageResult& damage) {
  std::vector<size_t> shown;
  for (size_t j = 0; j < damage.subjects.size(); ++j) {
    if (damage.subjects[j].place.empty() || damage.estimate.groups[j].changed) {
      shown.push_back(j);
    }
  }
  return shown;
}

bool IsSeen(const GroupChange& change) {
  return change.upper95 - change.lower95 < 20.0;
}

double LossProbability(const DamageResult& damage, size_t index) {
  return damage.subjects[index].kind == ChangeKind::kStiffness
             ? damage.estimate.groups[index].probability
             : std::numeric_limits<double>::quiet_NaN();
}

std::string FeatureUnit(const Feature& feature, const UnitSystem& units) {
  if (feature.OnDisplacement()) return UnitName(Dimension::kLength, units);
  if (feature.OnVelocity()) return UnitName(Dimension::kVelocity, units);
  if (feature.kind == Feature::Kind::kTime) return units.time;
  return "";
}

std::vector<std::string> RemarksOf(const ReportInput& input) {
  std::vector<std::string> remarks = input.problem->description.remarks;
  for (const IdentificationRecord& record : input.problem->records) {
    for (const std::string& remark : record.description.remarks) {
      remarks.push_back("Record " + record.name + ": " + remark);
    }
  }
  for (const std::string& remark : input.summary->remarks) {
    remarks.push_back(remark);
  }
  if (!input.prior.why_no_modes.empty()) {
    remarks.push_back("No modes: " + input.prior.why_no_modes);
  }
  return remarks;
}

}  // namespace pinode
