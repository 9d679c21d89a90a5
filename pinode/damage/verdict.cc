#include "pinode/damage/verdict.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

constexpr double kConfidence = 0.95;
// Largest number of names in a sentence; the table has them all.
constexpr size_t kMostNames = 4;
// Largest number of rivals in a sentence; damage.json has them all.
constexpr size_t kMostRivals = 3;
// Share of the largest nonlinear force below which a force may be due to the
// form of that one.
constexpr double kMinorForce = 0.25;
// Share of the restoring force below which a structure does not count as
// nonlinear.
constexpr double kLeastForce = 0.01;

// Ratio of the unexplained motion to that of the baselines, which differ by
// less. Measured ratios: a clock that is half a sample off 14, damage where
// there is no group 13, a gap sought as smooth forces 37, all changes that were
// sought and found 0.3 to 0.8.
constexpr double kMostMissed = 3.0;
// Unexplained motion from which a model counts as one that lacks something of
// the healthy structure too. A measured frame without damage, of which a shear
// model missed 27 to 37 %, "lost" 22 to 26 % of a storey from one level of
// motion to another.
constexpr double kMissedOfModels = 0.1;
// Unexplained motion so small that it can cause only small changes.
constexpr double kLittleMissed = 0.02;
// Limits for a nonlinear force. A gap leaves half of the motion that groups
// alone leave, and 1.7 times its share of the restoring force. Wrong clocks
// leave 0.9 and 3 or more.
constexpr double kMostOfGroups = 0.7;
constexpr double kMostOfForce = 2.5;

// Joins the first few texts, each once: several terms may describe one place.
// `all`: every text, as often as it comes.
std::string Join(const std::vector<std::string>& texts, bool all = false) {
  std::vector<std::string> different;
  for (const std::string& text : texts) {
    if (all || std::find(different.begin(), different.end(), text) ==
                   different.end()) {
      different.push_back(text);
    }
  }
  if (!all && different.size() > kMostNames + 1) {
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

// Returns P(Z > z).
double UpperTail(double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); }

// Returns the probability of a change, in its estimated direction, beyond the
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
    case ChangeKind::kDamping:
      if (!subject.place.empty()) return "the damping of " + subject.place;
      break;
    case ChangeKind::kStiffness:
      if (subject.place == "rest") return "the stiffness in no group";
      if (!subject.place.empty()) return "spring " + subject.place;
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

// Joins the likeliest few of `rivals`, which are in this order, in a sentence
// that begins with `begin`. None: empty.
std::string RivalSentence(const std::string& begin,
                          const std::vector<std::string>& rivals) {
  std::vector<std::string> different;
  for (const std::string& rival : rivals) {
    if (std::find(different.begin(), different.end(), rival) ==
        different.end()) {
      different.push_back(rival);
    }
  }
  if (different.empty()) return "";
  std::string sentence = " " + begin;
  if (different.size() > kMostRivals) {
    sentence += ", the first " + std::to_string(kMostRivals) + " of " +
                std::to_string(different.size());
    different.resize(kMostRivals);
  }
  return sentence + ": " + Join(different) + ".";
}

std::string DescribeMissed(const MissedMotion& missed,
                           const std::string& found) {
  return "These data cannot tell what has changed: none of the changes that "
         "were looked for explains it. Of the motion of the new records " +
         Percent(missed.last) +
         " is unexplained and too large to be noise; of the baselines' " +
         Percent(missed.healthy) +
         ". Check each sensor (clock, gain, place), each load (place, time, "
         "size) and the structure where there is no group." +
         (found.empty() ? "" : " A side effect, perhaps: " + found + ".");
}

// True for stiffness that is in no group. The healthy fits hold it as it is in
// the model, and do not show how much it differs between records.
bool IsInNoGroup(const ChangeSubject& subject) {
  return subject.kind == ChangeKind::kStiffness && !subject.place.empty();
}

bool HasChanged(Reason reason) {
  return reason == Reason::kBeyondThreshold ||
         reason == Reason::kBetweenRecords;
}

bool IsSet(const std::vector<bool>& flags, size_t j) {
  return j < flags.size() && flags[j];
}

std::vector<Reason> ReasonsOf(const std::vector<ChangeSubject>& subjects,
                              const ChangeEstimate& estimate,
                              const ChangeOptions& options,
                              const MissedMotion& missed) {
  std::vector<Reason> reasons;
  for (size_t j = 0; j < subjects.size(); ++j) {
    const GroupChange& change = estimate.groups[j];
    const double beyond =
        ProbabilityBeyond(subjects[j], change, options.threshold);
    Reason reason = Reason::kNone;
    if (change.changed && beyond >= kConfidence) {
      reason = Reason::kBeyondThreshold;
    } else if (change.changed && estimate.has_between_records &&
               !IsInNoGroup(subjects[j])) {
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
    if (HasChanged(reason) && !estimate.has_between_records &&
        subjects[j].kind != ChangeKind::kNonlinear &&
        missed.Hides(change.change)) {
      reason = Reason::kModelError;
    }
    if (HasChanged(reason) &&
        (missed.other_solution || IsSet(missed.mass_instead, j) ||
         (!estimate.has_between_records && IsSet(missed.within_doubt, j)))) {
      reason = Reason::kOtherExplanation;
    }
    // A shear model of a measured frame left 7 and 10 % of its motion
    // unexplained. From one level of motion to another its storeys "lost" up to
    // 47 %, so that no size of a change rules the level out.
    if (HasChanged(reason) && (missed.other_level || missed.unknown_level)) {
      reason = Reason::kOtherLevel;
    }
    if (IsSet(missed.loss_instead, j) &&
        (HasChanged(reason) || reason == Reason::kFormal ||
         reason == Reason::kUndetermined || reason == Reason::kNone)) {
      reason = Reason::kAmbiguous;
    }
    reasons.push_back(reason);
  }
  return reasons;
}

// Findings in words, by their meaning.
struct Findings {
  std::vector<std::string> damaged, nonlinear, minor, other, formal, unknown,
      unsure, unexplained, hidden, doubted, at_other_level;
  bool has_large_loss = false;     // among `damaged`
  bool has_possible_loss = false;  // among `unsure`
  bool has_between_records = false;
  bool level_may_hide = false;     // see MissedMotion::MayHideLoss
  bool has_unknown_level = false;  // see MissedMotion
  // Rivals of another kind, and of the same kind.
  std::vector<std::string> ambiguous, instead;
  // Losses of stiffness that explain the records in place of `damaged`, and
  // explanations by other changes of the same kind.
  std::vector<std::string> or_damaged, or_else;
  std::string probabilities;  // of `damaged` and `or_damaged`
  std::string missed;         // empty: nothing is
};

// Adds rivals: a change with a rival of another kind does not count.
void AddRivals(const std::vector<ChangeSubject>& subjects,
               const ChangeEstimate& estimate, std::vector<Reason>* reasons,
               Findings* findings) {
  std::vector<RivalChange> rivals = estimate.rivals;
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const RivalChange& a, const RivalChange& b) {
                     return a.loss < b.loss;
                   });
  for (const RivalChange& rival : rivals) {
    const size_t found = static_cast<size_t>(rival.found);
    const size_t other = static_cast<size_t>(rival.other);
    if (!estimate.groups[found].changed) continue;
    const std::string rival_text = Describe(subjects[other]);
    const std::string found_text = Describe(subjects[found]);
    const std::string text = rival_text + " instead of " + found_text;
    if (subjects[found].kind == subjects[other].kind) {
      // Two laws at one place have the same description.
      if (estimate.explanations.empty() && rival_text != found_text) {
        findings->instead.push_back(text);
      }
      continue;
    }
    if (HasChanged((*reasons)[found])) (*reasons)[found] = Reason::kAmbiguous;
    findings->ambiguous.push_back(text);
  }
}

// True if a subject is part of an explanation, so that its table says more.
bool IsExplanation(const ChangeEstimate& estimate, size_t subject) {
  for (const ChangeExplanation& explanation : estimate.explanations) {
    for (const int j : explanation.changed) {
      if (static_cast<size_t>(j) == subject) return true;
    }
  }
  return false;
}

// Adds explanations that were fitted in place of the first, if all changes of
// both are of one kind.
void AddExplanations(const std::vector<ChangeSubject>& subjects,
                     const ChangeEstimate& estimate, Findings* findings) {
  const auto percent = [](double probability) {
    return FormatNumber(std::round(100.0 * probability), 3) + " %";
  };
  std::vector<std::string> probabilities;
  for (const ChangeExplanation& explanation : estimate.explanations) {
    bool same_kind = true;
    bool losses = true;
    std::vector<std::string> texts;
    for (size_t k = 0; k < explanation.changed.size(); ++k) {
      const ChangeSubject& subject =
          subjects[static_cast<size_t>(explanation.changed[k])];
      const ChangeSubject& first =
          subjects[static_cast<size_t>(estimate.explanations[0].changed[0])];
      same_kind = same_kind && subject.kind == first.kind;
      losses = losses && subject.kind == ChangeKind::kStiffness &&
               explanation.changes[k].change < 0.0;
      texts.push_back(Describe(subject, explanation.changes[k]));
    }
    const bool is_first = &explanation == &estimate.explanations[0];
    if (is_first || (same_kind && losses)) {
      probabilities.push_back(percent(explanation.probability));
    }
    if (is_first || !same_kind) continue;
    if (losses) {
      findings->or_damaged.push_back(Join(texts));
    } else {
      findings->or_else.push_back(Join(texts) + " with a probability of " +
                                  percent(explanation.probability));
    }
  }
  findings->probabilities = Join(probabilities, /*all=*/true);
}

// Adds a subject that counts as changed.
void AddChange(const ChangeSubject& subject, const GroupChange& change,
               const ChangeOptions& options, double largest_force,
               Findings* findings) {
  const std::string text = Describe(subject, change);
  if (subject.kind == ChangeKind::kNonlinear) {
    (subject.force_share < kLeastForce                   ? findings->other
     : subject.force_share < kMinorForce * largest_force ? findings->minor
                                                         : findings->nonlinear)
        .push_back(text);
  } else if (subject.kind == ChangeKind::kStiffness && change.change < 0.0) {
    findings->damaged.push_back(text);
    findings->has_large_loss =
        findings->has_large_loss || change.change < -options.threshold;
  } else {
    findings->other.push_back(text);
  }
}

// Returns the subjects by size, large ones first.
std::vector<size_t> BySize(const std::vector<ChangeSubject>& subjects,
                           const ChangeEstimate& estimate) {
  std::vector<size_t> order(subjects.size());
  std::iota(order.begin(), order.end(), 0);
  const auto size_of = [&](size_t j) {
    return subjects[j].kind == ChangeKind::kNonlinear
               ? subjects[j].force_share
               : std::abs(estimate.groups[j].change);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return size_of(a) > size_of(b); });
  return order;
}

void AddChanges(const std::vector<ChangeSubject>& subjects,
                const ChangeEstimate& estimate, const ChangeOptions& options,
                const std::vector<Reason>& reasons, Findings* findings) {
  double largest_force = 0.0;
  for (size_t j = 0; j < subjects.size(); ++j) {
    if (subjects[j].kind == ChangeKind::kNonlinear && HasChanged(reasons[j])) {
      largest_force = std::max(largest_force, subjects[j].force_share);
    }
  }
  for (const size_t j : BySize(subjects, estimate)) {
    const GroupChange& change = estimate.groups[j];
    switch (reasons[j]) {
      case Reason::kBeyondThreshold:
      case Reason::kBetweenRecords:
        AddChange(subjects[j], change, options, largest_force, findings);
        break;
      case Reason::kFormal:
        findings->formal.push_back(Describe(subjects[j], change));
        break;
      case Reason::kUndetermined:
        if (!IsExplanation(estimate, j)) {
          findings->unknown.push_back(subjects[j].name);
        }
        break;
      case Reason::kAmbiguous:
        findings->has_possible_loss =
            findings->has_possible_loss ||
            (subjects[j].kind == ChangeKind::kStiffness &&
             change.lower95 < -options.threshold);
        findings->unsure.push_back(Describe(subjects[j], change));
        break;
      case Reason::kModelError:
        findings->hidden.push_back(Describe(subjects[j], change));
        break;
      case Reason::kOtherExplanation:
        findings->doubted.push_back(Describe(subjects[j], change));
        break;
      case Reason::kOtherLevel:
        findings->at_other_level.push_back(Describe(subjects[j], change));
        break;
      case Reason::kUnexplained:
        findings->unexplained.push_back(Describe(subjects[j], change));
        break;
      case Reason::kNone:
        break;
    }
  }
}

// Returns the end of a sentence on the changes that are no loss of stiffness.
std::string OtherChanges(const Findings& findings) {
  return (findings.other.size() > 1 ? "other changes were found: "
                                    : "another change was found: ") +
         Join(findings.other) + ".";
}

// Decides the verdict and its first sentence.
void Decide(const Findings& findings, const ChangeOptions& options,
            Judgement* judgement) {
  const std::string threshold = Percent(options.threshold);
  std::string damaged = Join(findings.damaged);
  for (const std::string& other : findings.or_damaged) {
    damaged += " or " + other;
  }
  const std::string lost =
      damaged + " lost stiffness." +
      (findings.has_large_loss
           ? ""
           : " This is below the threshold of " + threshold +
                 ", but more than the baselines differ from each other.");
  if (!findings.nonlinear.empty()) {
    judgement->verdict = DamageVerdict::kNonlinear;
    judgement->sentence =
        "The structure has become nonlinear: " + Join(findings.nonlinear) + ".";
    if (!findings.minor.empty()) {
      judgement->sentence +=
          " Smaller, and perhaps a side effect of the form assumed for the "
          "largest force: " +
          Join(findings.minor) + ".";
    }
    if (!findings.damaged.empty()) judgement->sentence += " Also, " + lost;
  } else if (!findings.damaged.empty()) {
    judgement->verdict = DamageVerdict::kDamage;
    judgement->sentence = "Damage: " + lost;
    if (!findings.or_damaged.empty()) {
      judgement->sentence +=
          " These records do not determine which. The probabilities are " +
          findings.probabilities + ".";
    }
  } else if (!findings.other.empty() && findings.doubted.empty() &&
             findings.hidden.empty() && findings.at_other_level.empty() &&
             !findings.level_may_hide && !findings.has_possible_loss) {
    judgement->verdict = DamageVerdict::kOtherChange;
    judgement->sentence = "No loss of stiffness, but " + OtherChanges(findings);
  } else if (!findings.missed.empty()) {
    judgement->verdict = DamageVerdict::kCannotTell;
    judgement->sentence = findings.missed;
  } else if (!findings.hidden.empty() || !findings.doubted.empty() ||
             !findings.at_other_level.empty() || !findings.unsure.empty() ||
             !findings.unknown.empty() || findings.level_may_hide) {
    judgement->verdict = DamageVerdict::kCannotTell;
    judgement->sentence =
        "These data cannot tell whether any group lost stiffness.";
  } else {
    judgement->verdict = DamageVerdict::kNoDamage;
    judgement->sentence =
        "No loss of stiffness beyond " + threshold + " in any group.";
  }
}

// Returns sentences on the level of motion, for a verdict that is open.
std::string LevelDetails(const Findings& findings) {
  const std::string changed =
      findings.at_other_level.empty()
          ? ""
          : " This may be all that changed: " + Join(findings.at_other_level) +
                ".";
  if (findings.has_unknown_level) {
    return " The model leaves motion unexplained, and the levels of motion "
           "cannot be compared: no sensor is common." +
           (changed.empty() ? " The level may hide a loss." : changed) +
           " Add a baseline with a sensor of the new records.";
  }
  return (changed.empty()
              ? " The new records are at another level of motion, which may "
                "hide a loss."
              : " The model leaves motion unexplained, and the new records are "
                "at another level of motion than the baselines." +
                    changed) +
         " Add a baseline at the level of the new records.";
}

void AddDetails(const Findings& findings, Judgement* judgement) {
  std::string& sentence = judgement->sentence;
  const bool is_open = !findings.doubted.empty() || !findings.hidden.empty() ||
                       findings.level_may_hide || findings.has_possible_loss;
  if ((!findings.damaged.empty() || !findings.nonlinear.empty() || is_open) &&
      !findings.other.empty()) {
    sentence += " Besides, " + OtherChanges(findings);
  }
  if (!findings.unsure.empty()) {
    sentence += " A change is possible, but the data allow another cause: " +
                Join(findings.unsure) + ".";
  }
  if (!findings.hidden.empty()) {
    sentence += " The unexplained motion is larger than the change of " +
                Join(findings.hidden) +
                ". It depends on the level of motion. Add a baseline at the "
                "level of the new record to see how much.";
  }
  if (findings.level_may_hide && findings.missed.empty() &&
      judgement->verdict == DamageVerdict::kCannotTell) {
    sentence += LevelDetails(findings);
  }
  if (!findings.doubted.empty()) {
    sentence +=
        " The model lacks something, and its likeliest explanations leave the "
        "change of " +
        Join(findings.doubted) +
        " open. See what the model may lack, or add a second baseline.";
  }
  if (!findings.formal.empty()) {
    sentence +=
        " Detectable, but not beyond the threshold with 95 % "
        "certainty: " +
        Join(findings.formal) +
        (findings.has_between_records
             ? ". The fits of the baselines hold the value of the "
               "model, so its normal scatter is unknown."
             : ". With one baseline the normal scatter is unknown.");
  }
  // A nonlinear force of another form than those tried leaves an error that
  // other subjects seem to explain. Which of them do it best is of no interest.
  // The same holds for side effects of causes that were not examined.
  if (judgement->verdict != DamageVerdict::kNonlinear &&
      findings.missed.empty()) {
    sentence += RivalSentence("Almost as likely", findings.ambiguous);
    sentence += RivalSentence("Another explanation", findings.or_else);
    sentence +=
        RivalSentence("Hard to tell apart with these data", findings.instead);
  }
  if (!findings.unknown.empty()) {
    sentence += " A loss beyond the threshold is not ruled out in " +
                Join(findings.unknown) + ".";
  }
}

}  // namespace

bool MissedMotion::IsMore() const {
  return last > std::max(kLittleMissed, kMostMissed * healthy);
}

bool MissedMotion::MayHideLoss() const {
  return other_level || unknown_level || level_hides_loss;
}

bool MissedMotion::Hides(double change) const {
  const double most = std::max(healthy, last);
  return most > kMissedOfModels && std::abs(change) < most;
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
  judgement.reasons = ReasonsOf(subjects, estimate, options, missed);
  const bool is_unexplained =
      missed.IsMore() && std::none_of(judgement.reasons.begin(),
                                      judgement.reasons.end(), HasChanged);
  Findings findings;
  findings.has_between_records = estimate.has_between_records;
  findings.level_may_hide = missed.MayHideLoss();
  findings.has_unknown_level = missed.unknown_level;
  AddRivals(subjects, estimate, &judgement.reasons, &findings);
  AddExplanations(subjects, estimate, &findings);
  AddChanges(subjects, estimate, options, judgement.reasons, &findings);
  if (is_unexplained) {
    findings.missed = DescribeMissed(missed, Join(findings.unexplained));
  }
  Decide(findings, options, &judgement);
  AddDetails(findings, &judgement);
  return judgement;
}

}  // namespace pinode
