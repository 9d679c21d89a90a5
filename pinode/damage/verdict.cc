#include "pinode/damage/verdict.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

constexpr double kConfidence = 0.95;
// A sentence with more names is read by nobody; the table has them all.
constexpr size_t kMostNames = 4;
// Of the largest nonlinear force: less may be what its form leaves over.
constexpr double kMinorForce = 0.25;
// Of the restoring force; nobody calls a structure nonlinear for less.
constexpr double kLeastForce = 0.01;

// Healthy records of a structure differ by less. A clock that is half a sample
// off misses 14 times as much, damage where no group is 13 times, a gap that is
// looked for as smooth forces 37 times, all else that was looked for and found
// 0.3 to 0.8 times.
constexpr double kMostMissed = 3.0;
// Too little for anything but small changes to stand in for it.
constexpr double kLittleMissed = 0.02;
// What the gap leaves is half of what groups alone do, and 1.7 times its part
// of the restoring force; where clocks are off 0.9 and 3 or more.
constexpr double kMostOfGroups = 0.7;
constexpr double kMostOfForce = 2.5;

// Each once: several terms may describe one place. The first few.
std::string Join(const std::vector<std::string>& texts) {
  std::vector<std::string> different;
  for (const std::string& text : texts) {
    if (std::find(different.begin(), different.end(), text) ==
        different.end()) {
      different.push_back(text);
    }
  }
  if (different.size() > kMostNames + 1) {
    const size_t more = different.size() - kMostNames;
    different.resize(kMostNames);
    different.push_back(std::to_string(more) + " more");
  }
  std::string joined;
  for (size_t i = 0; i < different.size(); ++i) {
    if (i > 0) joined += i + 1 == different.size() ? " and " : ", ";
    joined += different[i];
  }
  return joined;
}

std::string Percent(double fraction) {
  return FormatNumber(100.0 * fraction, 3) + " %";
}

// P(Z > z).
double UpperTail(double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); }

// The probability of a change, in the direction that it has, beyond the
// threshold.
double ProbabilityBeyond(const ChangeSubject& subject,
                         const GroupChange& change, double threshold) {
  if (subject.kind == ChangeKind::kNonlinear) {
    if (!(subject.force_share > 0.0)) return 0.0;
    threshold *= std::abs(change.change) / subject.force_share;
  } else if (change.change < 0.0) {
    return change.probability;
  }
  return UpperTail((threshold - std::abs(change.change)) / change.sigma);
}

std::string Describe(const ChangeSubject& subject) {
  switch (subject.kind) {
    case ChangeKind::kNonlinear:
      return "a nonlinear force at " + subject.place;
    case ChangeKind::kMass:
      if (!subject.place.empty()) return "the mass at " + subject.place;
      break;
    case ChangeKind::kStiffness:
    case ChangeKind::kDamping:
      break;
  }
  return subject.name;
}

std::string Describe(const ChangeSubject& subject, const GroupChange& change) {
  const bool nonlinear = subject.kind == ChangeKind::kNonlinear;
  return Describe(subject) + " (" +
         (nonlinear
              ? Percent(subject.force_share) + " of the restoring force"
              : (change.change > 0.0 ? "+" : "") + Percent(change.change)) +
         ")";
}

std::string DescribeMissed(const MissedMotion& missed,
                           const std::string& found) {
  return "These data cannot tell: something has changed that is none of what "
         "was looked for. Of the motion of the new records the model misses " +
         Percent(missed.last) + " that is no noise, of the healthy ones " +
         Percent(missed.healthy) +
         ": a sensor or its clock, gain or place, a load of another place, "
         "time or size, or a change where no group is." +
         (found.empty() ? "" : " What stands in for it: " + found + ".");
}

bool HasChanged(Reason reason) {
  return reason == Reason::kBeyondThreshold ||
         reason == Reason::kBetweenRecords;
}

}  // namespace

bool MissedMotion::IsMore() const {
  return last > std::max(kLittleMissed, kMostMissed * healthy);
}

bool MissedMotion::LeavesForce(double force_share) const {
  return last < kMostOfGroups * groups && last < kMostOfForce * force_share;
}

const char* DamageVerdictName(DamageVerdict verdict) {
  switch (verdict) {
    case DamageVerdict::kNoDamage:
      return "no_damage";
    case DamageVerdict::kDamage:
      return "damage";
    case DamageVerdict::kNonlinear:
      return "nonlinear";
    case DamageVerdict::kOtherChange:
      return "other_change";
    case DamageVerdict::kCannotTell:
      return "cannot_tell";
  }
  return "";
}

const char* ChangeKindName(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kStiffness:
      return "stiffness";
    case ChangeKind::kDamping:
      return "damping";
    case ChangeKind::kMass:
      return "mass";
    case ChangeKind::kNonlinear:
      return "nonlinear";
  }
  return "";
}

ChangeKind KindOf(MatrixGroup::Target target) {
  switch (target) {
    case MatrixGroup::Target::kMass:
      return ChangeKind::kMass;
    case MatrixGroup::Target::kDamping:
      return ChangeKind::kDamping;
    case MatrixGroup::Target::kStiffness:
      break;
  }
  return ChangeKind::kStiffness;
}

Judgement JudgeChange(const std::vector<ChangeSubject>& subjects,
                      const ChangeEstimate& estimate,
                      const ChangeOptions& options,
                      const MissedMotion& missed) {
  CHECK_EQ(subjects.size(), estimate.groups.size());
  Judgement judgement;
  for (size_t j = 0; j < subjects.size(); ++j) {
    const GroupChange& change = estimate.groups[j];
    const double beyond =
        ProbabilityBeyond(subjects[j], change, options.threshold);
    Reason reason = Reason::kNone;
    if (change.changed && beyond >= kConfidence) {
      reason = Reason::kBeyondThreshold;
    } else if (change.changed && estimate.has_between_records) {
      reason = Reason::kBetweenRecords;
    } else if (change.changed) {
      reason = Reason::kFormal;
    } else if (subjects[j].kind == ChangeKind::kStiffness &&
               change.probability > 1.0 - kConfidence) {
      reason = Reason::kUndetermined;
    }
    const bool stands =
        !missed.IsMore() || (subjects[j].kind == ChangeKind::kNonlinear &&
                             missed.LeavesForce(subjects[j].force_share));
    if (HasChanged(reason) && !stands) reason = Reason::kUnexplained;
    judgement.reasons.push_back(reason);
  }
  const bool is_unexplained =
      missed.IsMore() && std::none_of(judgement.reasons.begin(),
                                      judgement.reasons.end(), HasChanged);
  std::vector<std::string> ambiguous;
  std::vector<std::string> instead;
  for (const RivalChange& rival : estimate.rivals) {
    const size_t found = static_cast<size_t>(rival.found);
    const size_t other = static_cast<size_t>(rival.other);
    if (!estimate.groups[found].changed) continue;
    if (subjects[found].kind != subjects[other].kind) {
      if (HasChanged(judgement.reasons[found])) {
        judgement.reasons[found] = Reason::kAmbiguous;
      }
      ambiguous.push_back(Describe(subjects[other]) + " for " +
                          Describe(subjects[found]));
    } else {
      instead.push_back(Describe(subjects[other]) + " for " +
                        Describe(subjects[found]));
    }
  }

  std::vector<std::string> damaged, nonlinear, minor, other, formal, unknown,
      unsure, unexplained;
  // Large ones first.
  std::vector<size_t> order(subjects.size());
  std::iota(order.begin(), order.end(), 0);
  const auto size_of = [&](size_t j) {
    return subjects[j].kind == ChangeKind::kNonlinear
               ? subjects[j].force_share
               : std::abs(estimate.groups[j].change);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return size_of(a) > size_of(b); });
  double largest_force = 0.0;
  for (size_t j = 0; j < subjects.size(); ++j) {
    if (subjects[j].kind == ChangeKind::kNonlinear &&
        HasChanged(judgement.reasons[j])) {
      largest_force = std::max(largest_force, subjects[j].force_share);
    }
  }
  bool is_small = true;  // all losses
  for (const size_t j : order) {
    const GroupChange& change = estimate.groups[j];
    const ChangeKind kind = subjects[j].kind;
    const std::string text = Describe(subjects[j], change);
    switch (judgement.reasons[j]) {
      case Reason::kBeyondThreshold:
      case Reason::kBetweenRecords:
        if (kind == ChangeKind::kNonlinear) {
          (subjects[j].force_share < kLeastForce                   ? other
           : subjects[j].force_share < kMinorForce * largest_force ? minor
                                                                   : nonlinear)
              .push_back(text);
        } else {
          (kind == ChangeKind::kStiffness && change.change < 0.0 ? damaged
                                                                 : other)
              .push_back(text);
          is_small = is_small && !(change.change < -options.threshold);
        }
        break;
      case Reason::kFormal:
        formal.push_back(text);
        break;
      case Reason::kUndetermined:
        unknown.push_back(subjects[j].name);
        break;
      case Reason::kAmbiguous:
        unsure.push_back(text);
        break;
      case Reason::kUnexplained:
        unexplained.push_back(text);
        break;
      case Reason::kNone:
        break;
    }
  }
  const std::string lost =
      Join(damaged) + " lost stiffness" +
      (is_small ? ", less than the threshold of " + Percent(options.threshold) +
                      " but more than healthy records differ."
                : ".");
  if (!nonlinear.empty()) {
    judgement.verdict = DamageVerdict::kNonlinear;
    judgement.sentence =
        "The structure has become nonlinear: " + Join(nonlinear) + ".";
    if (!minor.empty()) {
      judgement.sentence +=
          " Smaller, and perhaps only what the form of that "
          "leaves over: " +
          Join(minor) + ".";
    }
    if (!damaged.empty()) judgement.sentence += " Besides, " + lost;
  } else if (!damaged.empty()) {
    judgement.verdict = DamageVerdict::kDamage;
    judgement.sentence = "Damage: " + lost;
  } else if (!other.empty()) {
    judgement.verdict = DamageVerdict::kOtherChange;
    judgement.sentence = "No loss of stiffness, but " + Join(other) +
                         (other.size() > 1 ? " have" : " has") + " changed.";
  } else if (is_unexplained) {
    judgement.verdict = DamageVerdict::kCannotTell;
    judgement.sentence = DescribeMissed(missed, Join(unexplained));
  } else if (!unsure.empty() || !unknown.empty()) {
    judgement.verdict = DamageVerdict::kCannotTell;
    judgement.sentence = "These data cannot tell.";
  } else {
    judgement.verdict = DamageVerdict::kNoDamage;
    judgement.sentence = "No loss of stiffness beyond " +
                         Percent(options.threshold) + " in any group.";
  }
  if ((!damaged.empty() || !nonlinear.empty()) && !other.empty()) {
    judgement.sentence += " Also changed: " + Join(other) + ".";
  }
  if (!unsure.empty()) {
    judgement.sentence += " Something has changed, perhaps " + Join(unsure) +
                          ": another kind of change explains it nearly as "
                          "well.";
  }
  if (!formal.empty()) {
    judgement.sentence +=
        " Formally significant, but not beyond the threshold with certainty, "
        "and one healthy record does not show how much records differ: " +
        Join(formal) + ".";
  }
  // A nonlinear force of another form than those tried for it leaves something
  // for all others to explain; which of them do it best is of no interest.
  // Nor what else stands in for what was not looked for.
  if (judgement.verdict == DamageVerdict::kNonlinear || is_unexplained) {
    ambiguous.clear();
    instead.clear();
  }
  if (!ambiguous.empty()) {
    judgement.sentence +=
        " Nearly as good an explanation: " + Join(ambiguous) + ".";
  }
  if (!instead.empty()) {
    judgement.sentence +=
        " Hardly told apart by these data: " + Join(instead) + ".";
  }
  if (!unknown.empty()) {
    judgement.sentence += " A loss beyond the threshold is not ruled out in " +
                          Join(unknown) + ".";
  }
  return judgement;
}

}  // namespace pinode
