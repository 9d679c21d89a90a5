#include "pinode/damage/verdict.h"

#include <cmath>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

constexpr double kConfidence = 0.95;

std::string Join(const std::vector<std::string>& names) {
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

std::string Percent(double fraction) {
  return FormatNumber(100.0 * fraction, 3) + " %";
}

}  // namespace

const char* DamageVerdictName(DamageVerdict verdict) {
  switch (verdict) {
    case DamageVerdict::kNoDamage:
      return "no_damage";
    case DamageVerdict::kDamage:
      return "damage";
    case DamageVerdict::kOtherChange:
      return "other_change";
    case DamageVerdict::kCannotTell:
      return "cannot_tell";
  }
  return "";
}

Judgement JudgeChange(const std::vector<std::string>& names,
                      const std::vector<MatrixGroup::Target>& targets,
                      const ChangeEstimate& estimate,
                      const ChangeOptions& options) {
  CHECK_EQ(names.size(), estimate.groups.size());
  CHECK_EQ(targets.size(), estimate.groups.size());
  Judgement judgement;
  std::vector<std::string> damaged, other, formal, unknown;
  for (size_t j = 0; j < names.size(); ++j) {
    const GroupChange& group = estimate.groups[j];
    const bool stiffness = targets[j] == MatrixGroup::Target::kStiffness;
    // A gain as much as a loss.
    const double beyond =
        group.change < 0.0
            ? group.probability
            : 0.5 * std::erfc((options.threshold - group.change) /
                              (group.sigma * std::sqrt(2.0)));
    const std::string text = names[j] + " (" + (group.change > 0.0 ? "+" : "") +
                             Percent(group.change) + ")";
    Reason reason = Reason::kNone;
    if (group.changed && beyond >= kConfidence) {
      reason = Reason::kBeyondThreshold;
    } else if (group.changed && estimate.has_between_records) {
      reason = Reason::kBetweenRecords;
    } else if (group.changed) {
      reason = Reason::kFormal;
    } else if (stiffness && group.probability > 1.0 - kConfidence) {
      reason = Reason::kUndetermined;
    }
    judgement.reasons.push_back(reason);
    switch (reason) {
      case Reason::kBeyondThreshold:
      case Reason::kBetweenRecords:
        (stiffness && group.change < 0.0 ? damaged : other).push_back(text);
        break;
      case Reason::kFormal:
        formal.push_back(text);
        break;
      case Reason::kUndetermined:
        unknown.push_back(names[j]);
        break;
      case Reason::kNone:
        break;
    }
  }
  if (!damaged.empty()) {
    judgement.verdict = DamageVerdict::kDamage;
    judgement.sentence = "Damage: " + Join(damaged) + " lost stiffness.";
  } else if (!other.empty()) {
    judgement.verdict = DamageVerdict::kOtherChange;
    judgement.sentence = "No loss of stiffness, but " + Join(other) +
                         (other.size() > 1 ? " have" : " has") + " changed.";
  } else if (!unknown.empty()) {
    judgement.verdict = DamageVerdict::kCannotTell;
    judgement.sentence = "These data cannot tell.";
  } else {
    judgement.verdict = DamageVerdict::kNoDamage;
    judgement.sentence = "No loss of stiffness beyond " +
                         Percent(options.threshold) + " in any group.";
  }
  if (!damaged.empty() && !other.empty()) {
    judgement.sentence += " Also changed: " + Join(other) + ".";
  }
  if (!formal.empty()) {
    judgement.sentence +=
        " Formally significant, but not beyond the threshold with certainty, "
        "and one healthy record does not show how much records differ: " +
        Join(formal) + ".";
  }
  if (!unknown.empty()) {
    judgement.sentence += " A loss beyond the threshold is not ruled out in " +
                          Join(unknown) + ".";
  }
  return judgement;
}

}  // namespace pinode
