#include "pinode/study/damage/damage_analysis.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/motion_levels.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/damage/baseline_of_modes.h"
#include "pinode/study/damage/change_explanations.h"
#include "pinode/study/damage/change_refit.h"
#include "pinode/study/damage/damage_remarks.h"
#include "pinode/study/damage/healthy_records.h"
#include "pinode/study/damage/kinds_search.h"
#include "pinode/study/damage/linear_causes.h"
#include "pinode/study/damage/loss_instead.h"
#include "pinode/study/damage/mass_instead.h"
#include "pinode/study/damage/result_subjects.h"
#include "pinode/study/damage/scale_instead.h"
#include "pinode/study/damage/wide_state.h"
#include "pinode/study/damage/within_doubt.h"
#include "pinode/study/explanations/modes_search.h"
#include "pinode/study/identify/identify.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {
namespace {

// As in MissedOf, for new records.
constexpr double kLeastMissed = 0.3;

constexpr char kNewRecords[] = "the new records";

using Candidates = std::vector<ChangeCandidate>;

// Motion that an explanation with fewer unknowns may leave to be as good as the
// fit of `summary`: somewhat more, or what noise alone may be taken for. A
// force gauge of 1.1, alone or beside a loss, left 0.04 to 0.70 of what the
// changes left that stood for it (four runs). Faults that were none left 7
// times as much (four masses grew by 8 to 12 %) and 19 times.
double LeftOrNoise(const FitSummary& summary) {
  constexpr double kSomewhatMore = 1.5;
  double left = kSomewhatMore * MissedOf(summary, 0.0);
  for (const RecordScore& record : summary.records) {
    if (record.role == IdentificationRecord::Role::kTrain) {
      left = std::max(left, kLeastMissed * record.nrmse);
    }
  }
  return left;
}

// True if a mass is an unknown: one factor on all of stiffness, damping and
// mass is then determined by measured forces alone.
bool HasMass(const std::vector<ChangeSubject>& subjects) {
  return std::any_of(subjects.begin(), subjects.end(),
                     [](const ChangeSubject& subject) {
                       return subject.kind == ChangeKind::kMass;
                     });
}

class Analyst {
 public:
  Analyst(const IdentificationProblem& problem,
          const std::vector<Baseline>& baselines,
          const DamageAnalysisOptions& options, DamageResult* result)
      : problem_(problem),
        baselines_(baselines),
        identification_(options.identification),
        search_(options.search),
        options_(options.change),
        inner_(options.watch),
        groups_(FreeGroups(*problem.dynamics)),
        healthy_records_(baselines, problem, groups_, options.identification),
        result_(*result),
        subjects_(groups_.size(), &candidates_, &result->subjects,
                  &result->estimate) {}

  bool Run(const IdentificationSummary& summary, const IdentifiedModel& model,
           std::string* error) {
    for (const Baseline& baseline : baselines_) {
      result_.baselines.push_back(baseline.name);
      RemarkWhatIsOpen("baseline '" + baseline.name + "'",
                       baseline.undetermined, &result_.remarks);
    }
    RemarkWhatIsOpen(kNewRecords, summary.undetermined, &result_.remarks);
    result_.options = options_;
    fit_of_new_ = {kNewRecords, problem_, summary, model};
    fit_of_groups_ = fit_of_new_;
    missed_by_groups_ = MissedOf(summary, kLeastMissed);
    candidates_ = MakeChangeCandidates(problem_, search_, summary, model);
    AddPlaces(candidates_);
    std::string why;
    verdict_ = summary.verdict;
    choice_ = summary.choice;
    explanations_ = summary.explanations;
    doubts_ = DoubtsOf(summary);
    const bool kinds = !candidates_.empty() && LookForKinds(&why) &&
                       (found_.empty() || IdentifyWithFound(&why));
    if (!why.empty()) {
      result_.remarks.push_back(
          "The kinds of change could not be told apart: " + why + ".");
    }
    if (kinds && IsFaultInstead(summary.explanations, error)) return false;
    if (!kinds) {
      found_.clear();
      fit_of_new_ = {kNewRecords, problem_, summary, model};
    }
    return Conclude(kinds, error);
  }

 private:
  // found_, fit_of_new_ and candidates_, with the search that found them.
  bool LookForKinds(std::string* error) {
    kinds_.emplace(groups_, options_, identification_, &healthy_records_,
                   &inner_, fit_of_groups_, candidates_);
    if (!kinds_->Run(explanations_, verdict_.usable(), error)) return false;
    candidates_ = kinds_->candidates();
    AddPlaces(candidates_);
    found_ = kinds_->found();
    fit_of_new_ = kinds_->TakeFit();
    return true;
  }

  // Adds the places of `candidates` to those of the result, each once.
  void AddPlaces(const Candidates& candidates) {
    for (const ChangeCandidate& candidate : candidates) {
      const std::string place =
          std::string(ChangeKindName(candidate.subject.kind)) + " at " +
          candidate.subject.place;
      if (std::find(result_.places.begin(), result_.places.end(), place) ==
          result_.places.end()) {
        result_.places.push_back(place);
      }
    }
  }

  // True, with *error, if faults of the measurement explain the new records as
  // well as the changes that were found.
  bool IsFaultInstead(const std::vector<Explanation>& explanations,
                      std::string* error) const {
    if (problem_.num_train_records() == 0) return false;
    const Explanation* fault = FaultInsteadOfChanges(
        explanations, found_.size(), LeftOrNoise(fit_of_new_.summary));
    if (fault == nullptr) return false;
    const bool is_one = fault->kind.find('+') == std::string::npos;
    *error = std::string(is_one ? "one fault of the measurement explains"
                                : "faults of the measurement explain") +
             " the new records as well as " + std::to_string(found_.size()) +
             " changes of the structure: " + fault->what +
             ". Check it, correct the case and run again";
    return true;
  }

  // The result with the kinds of change that were found, by the main job.
  bool IdentifyWithFound(std::string* error) {
    IdentificationOptions options = identification_;
    BeginNearTheEnd(&options);
    IdentificationExtras extras;
    extras.start = &fit_of_new_.model;
    Identification found =
        Identify(fit_of_new_.problem, options, extras, inner_.watch());
    if (!found.summary.usable()) {
      *error = "the result with " + found_[0].subject.name +
               (found_.size() > 1 ? " and others" : "") +
               " is not usable: " + found.summary.message;
      return false;
    }
    // A fit from there looks for no other solution.
    if (!doubts_.other_solution) doubts_ = DoubtsOf(found.summary);
    verdict_ = std::move(found.summary.verdict);
    choice_ = std::move(found.summary.choice);
    explanations_ = std::move(found.summary.explanations);
    fit_of_new_ = {kNewRecords, std::move(found.problem),
                   std::move(found.summary), std::move(found.model)};
    return true;
  }

  bool Conclude(bool kinds, std::string* error) {
    if (!verdict_.usable()) {
      *error = WhyNotUsable();
      return false;
    }
    Comparison states;
    if (!Compare(kinds, &states, error)) return false;
    if (kinds && !AddRivals(error)) return false;
    if (!ExplainChange(states.options, error)) return false;
    RemarkWhatDiffers(states.healthy, states.current, groups_, result_.estimate,
                      &result_.remarks);
    // If changes were refitted, the other solution of the new records is
    // among their explanations.
    const bool is_open =
        doubts_.other_solution && result_.estimate.explanations.empty();
    MissedMotion missed = Missed(states, is_open);
    if (IsOfModes(problem_)) LookForMass(states, &missed);
    std::vector<MassesInstead> masses;
    if (kinds &&
        (!FindLossesInstead(*kinds_, options_, &subjects_, &missed.loss_instead,
                            error) ||
         !FindScaleInstead(
             {kinds_->healthy(), kinds_->current(), kinds_->is_logarithm()},
             options_, &subjects_, &missed.loss_instead, &masses, error))) {
      return false;
    }
    result_.judgement =
        JudgeChange(result_.subjects, result_.estimate, options_, missed);
    if (result_.judgement.verdict != DamageVerdict::kCannotTell) {
      RemarkWhatIsMissed(missed, &result_.remarks);
    }
    SayWhatExplains();
    if (result_.judgement.verdict == DamageVerdict::kDamage ||
        result_.judgement.verdict == DamageVerdict::kCannotTell) {
      RemarkMassesInstead(masses, subjects_, &result_.remarks);
    }
    if (kinds && states.healthy.size() == 1 && IsOpenAlone(missed)) {
      RemarkMass();
    }
    for (const Baseline& baseline : baselines_) {
      RemarkAnotherSolution("baseline '" + baseline.name + "'", baseline.doubts,
                            &result_.remarks);
    }
    if (is_open) {
      RemarkAnotherSolution(kNewRecords, doubts_, &result_.remarks);
    }
    GiveFit();
    return true;
  }

  // Reason why the fit of the new records cannot be used, and its remedy.
  std::string WhyNotUsable() const {
    const std::string why = "the fit to the new records is not usable";
    const Explanation* best = ExplanationOfAll();
    if (best == nullptr) {
      return why +
             ", and no change of another kind explains the remaining motion";
    }
    return why + ". This explains them: " + best->what +
           ". Check it, correct the case and run again";
  }

  // States of groups and of found candidates, and the options to compare them.
  struct Comparison {
    std::vector<GroupState> healthy;
    GroupState current;
    ChangeOptions options;
  };

  // Sets the subjects of the result and their changes, and *states.
  bool Compare(bool kinds, Comparison* states, std::string* error) {
    for (const GroupTerm& term : problem_.dynamics->groups()) {
      if (std::find(groups_.begin(), groups_.end(), term.group.name) ==
          groups_.end()) {
        continue;
      }
      ChangeSubject subject;
      subject.name = term.group.name;
      subject.kind = KindOf(term.group.target);
      result_.subjects.push_back(std::move(subject));
    }
    SetForceShares(fit_of_new_.problem, fit_of_new_.summary, fit_of_new_.model,
                   &found_);
    std::vector<std::string> names = groups_;
    for (const ChangeCandidate& candidate : found_) {
      names.push_back(candidate.subject.name);
      result_.subjects.push_back(candidate.subject);
    }
    std::vector<GroupState>& healthy = states->healthy;
    GroupState& current = states->current;
    if (!healthy_records_.States(fit_of_new_, found_, &healthy, error)) {
      return false;
    }
    if (!GroupsOf(*fit_of_new_.problem.dynamics, fit_of_new_.summary, names,
                  &current, error)) {
      return false;
    }
    ScaleToUnits(found_, &current);
    ChangeOptions& options = states->options;
    options = OptionsFor(
        options_, groups_.size(), found_,
        (kinds ? 1.0 - kShareOfKinds : 1.0) * options_.false_alarm_rate);
    // The change of what is nearly gone is one of the group's nominal value.
    const std::vector<bool> gone = NearlyGone(healthy);
    for (size_t j = 0; j < gone.size(); ++j) {
      if (gone[j]) options.absolute[j] = true;
    }
    return HasMass(subjects_.subjects())
               ? EstimateChangeByLogarithms(groups_.size(), found_, healthy,
                                            current, options, &result_.estimate,
                                            error)
               : EstimateChange(healthy, current, options, &result_.estimate,
                                error);
  }

  // Rivals among all candidates; a candidate that is one becomes a subject.
  bool AddRivals(std::string* error) {
    std::vector<RivalChange> rivals;
    if (!FindRivals(kinds_->healthy(), kinds_->current(),
                    kinds_->WideOptions(options_.false_alarm_rate),
                    subjects_.ChangedEntries(), &rivals, error)) {
      return false;
    }
    subjects_.SetRivals(rivals);
    return true;
  }

  // Moves the fit of the new records and its verdict to the result.
  void GiveFit() {
    result_.added = std::move(found_);
    result_.problem = std::move(fit_of_new_.problem);
    result_.summary = IdentificationSummary(std::move(fit_of_new_.summary));
    result_.summary.verdict = std::move(verdict_);
    result_.summary.choice = std::move(choice_);
    result_.summary.explanations = std::move(explanations_);
    result_.model = std::move(fit_of_new_.model);
  }

  // True if the verdict is open for no other reason than wide intervals.
  bool IsOpenAlone(const MissedMotion& missed) const {
    const Judgement& judgement = result_.judgement;
    return judgement.verdict == DamageVerdict::kCannotTell &&
           !missed.IsMore() && !missed.other_solution &&
           !missed.MayHideLoss() &&
           std::none_of(judgement.reasons.begin(), judgement.reasons.end(),
                        [](Reason reason) {
                          return reason == Reason::kUnexplained ||
                                 reason == Reason::kModelError ||
                                 reason == Reason::kOtherExplanation;
                        });
  }
  void RemarkMass() {
    const auto groups = result_.subjects.begin();
    RemarkMassInstead(
        kinds_->healthy()[0], kinds_->current(), kinds_->is_logarithm(),
        {groups, groups + static_cast<std::ptrdiff_t>(groups_.size())},
        candidates_, found_, &result_.remarks);
  }

  // Unexplained motion, zero without fits of the healthy records, and doubts.
  // `is_open`: the new records have another solution.
  MissedMotion Missed(const Comparison& states, bool is_open) const {
    MissedMotion missed;
    if (!healthy_records_.fits().empty()) {
      for (const FitOfRecords& fit : healthy_records_.fits()) {
        missed.healthy = std::max(missed.healthy, MissedOf(fit.summary, 0.0));
      }
      missed.groups = missed_by_groups_;
      missed.last = MissedOf(fit_of_new_.summary, kLeastMissed);
    }
    missed.other_solution =
        is_open || std::any_of(baselines_.begin(), baselines_.end(),
                               [](const Baseline& baseline) {
                                 return baseline.doubts.other_solution;
                               });
    CompareLevelsOfMotion(states, &missed);
    // Several baselines show themselves how much records differ.
    if (states.healthy.size() == 1) {
      missed.within_doubt = WithinDoubt(
          {states.healthy[0], baselines_[0].doubts},
          {states.current, doubts_, MissesMotion(verdict_)}, groups_,
          result_.subjects, result_.estimate, states.options);
    }
    return missed;
  }

  // Sets flags on the level of motion, if the model leaves motion unexplained.
  void CompareLevelsOfMotion(const Comparison& states,
                             MissedMotion* missed) const {
    bool misses_motion = doubts_.misses_motion;
    bool had_records = false;
    std::vector<MotionLevel> had;
    for (size_t i = 0; i < baselines_.size(); ++i) {
      const Baseline& baseline = baselines_[i];
      misses_motion =
          misses_motion || (found_.empty() ? baseline.doubts.misses_motion
                                           : healthy_records_.LeavesMotion(i));
      had_records = had_records || baseline.has_records;
      had.insert(had.end(), baseline.levels.begin(), baseline.levels.end());
    }
    if (!misses_motion) return;
    const std::vector<MotionLevel> now = MotionLevels(problem_);
    const LevelComparison levels = CompareLevels(had, now);
    if (levels == LevelComparison::kSame) return;
    // Values under one explanation are compared with one baseline alone, and
    // only those of groups.
    if (states.healthy.size() == 1 && found_.empty()) {
      const std::vector<ExplainedValue> changes =
          ChangesUnderOne({states.healthy[0], baselines_[0].doubts}, doubts_,
                          groups_, result_.estimate, states.options);
      if (!changes.empty()) {
        missed->level_hides_loss = std::any_of(
            changes.begin(), changes.end(), [this](const ExplainedValue& own) {
              return own.lower95 < -options_.threshold;
            });
        return;
      }
    }
    missed->other_level = levels == LevelComparison::kOther;
    // Short records and results of earlier versions have no levels. They are
    // judged as before there were any, by the unexplained share, the reach of
    // explanations and the scatter between baselines. Modes alone come from
    // motion of another kind than records, often much weaker. Two sets of modes
    // are compared as ever: their own misfits are checked.
    const bool has_records =
        problem_.num_train_records() > 0 || !problem_.ambient.empty();
    missed->unknown_level =
        levels == LevelComparison::kUnknown &&
        ((!had.empty() && !now.empty()) || had_records != has_records);
  }

  // A mass may have been added, which modes hardly tell from changed stiffness.
  void LookForMass(const Comparison& states, MissedMotion* missed) {
    std::map<std::string, double> changed;
    for (size_t j = 0; j < groups_.size(); ++j) {
      if (!result_.estimate.groups[j].changed) continue;
      double before = 0.0;
      for (const GroupState& state : states.healthy) {
        before += state.values[static_cast<Eigen::Index>(j)] /
                  static_cast<double>(states.healthy.size());
      }
      const double change = result_.estimate.groups[j].change;
      changed[groups_[j]] =
          before +
          (states.options.absolute[j] ? change : (1.0 + before) * change);
    }
    if (changed.empty()) return;
    const std::string mass =
        MassInstead(problem_, identification_, fit_of_new_.model, groups_,
                    states.healthy, changed, &inner_);
    if (mass.empty()) return;
    for (size_t j = 0; j < groups_.size(); ++j) {
      missed->mass_instead.push_back(result_.estimate.groups[j].changed);
    }
    result_.remarks.push_back(
        "The modes may show a mass instead of changed stiffness: " + mass +
        ".");
  }

  // Refits what was found, and other sets of changes, each alone; the values
  // of the likeliest replace those of the linearisation. False, with *error,
  // where a fit was interrupted.
  bool ExplainChange(const ChangeOptions& options, std::string* error) {
    const std::vector<int> found = subjects_.ChangedEntries();
    bool is_linear = true;
    for (size_t j = 0; j < result_.subjects.size(); ++j) {
      if (!result_.estimate.groups[j].changed) continue;
      is_linear =
          is_linear && result_.subjects[j].kind != ChangeKind::kNonlinear;
    }
    // Nonlinear forces have forms that none of those tried need have.
    if (found.empty() || !is_linear) return true;
    ChangeRefitter refitter(fit_of_groups_, fit_of_new_, groups_,
                            identification_, &inner_);
    if (!refitter.WhyNot().empty()) return true;
    const std::vector<bool> absolute(
        options.absolute.begin(),
        options.absolute.begin() + static_cast<std::ptrdiff_t>(groups_.size()));
    BaselinesNear near;
    std::optional<BaselineOfModes> modes;
    if (baselines_.size() == 1 && !healthy_records_.MovesWithCovariates() &&
        BaselineOfModes::IsOne(baselines_[0])) {
      modes.emplace(baselines_[0], groups_);
      near = [&modes](const Vector& values, PooledBaselines* pooled) {
        return modes->Near(values, pooled);
      };
    }
    ChangeExplanations search(
        &refitter, absolute, candidates_,
        [this](const Candidates& candidates, std::vector<GroupState>* states) {
          std::string unused;
          return healthy_records_.States(fit_of_new_, candidates, states,
                                         &unused);
        },
        near, options);
    ExplainedChange explained;
    const bool thorough = problem_.num_train_records() == 0;
    if (!search.Run(found, subjects_.RivalEntries(), thorough, &explained)) {
      if (!refitter.interrupted()) return true;
      *error = "interrupted";
      return false;
    }
    subjects_.TakeOver(explained);
    return true;
  }

  // The likeliest explanation of the new records, if only noise is left with
  // it; nullptr else.
  const Explanation* ExplanationOfAll() const {
    if (explanations_.empty()) return nullptr;
    const Explanation& best = explanations_[0];
    const bool is_whole = best.log_odds > limits::kLogOdds &&
                          best.leaves < limits::kNotedUnexplained;
    return is_whole ? &best : nullptr;
  }

  // No subject can be a sensor or a clock, which may be all there is.
  void SayWhatExplains() {
    const Explanation* best = ExplanationOfAll();
    if (result_.judgement.verdict != DamageVerdict::kCannotTell ||
        best == nullptr) {
      return;
    }
    result_.remarks.push_back(
        "Nothing but noise is left of the new records with this explanation: " +
        best->what + ". Check it first.");
  }

  const IdentificationProblem& problem_;
  const std::vector<Baseline>& baselines_;
  const IdentificationOptions& identification_;
  const DamageSearch& search_;
  const ChangeOptions& options_;
  InnerFit inner_;
  const std::vector<std::string> groups_;
  HealthyRecords healthy_records_;
  DamageResult& result_;

  Candidates candidates_, found_;
  ResultSubjects subjects_;
  FitOfRecords fit_of_new_, fit_of_groups_;
  // Verdict, doubts, choice and explanations of the result in fit_of_new_.
  Verdict verdict_;
  Doubts doubts_;
  ModelChoice choice_;
  std::vector<Explanation> explanations_;
  double missed_by_groups_ = 0.0;     // see MissedMotion
  std::optional<KindsSearch> kinds_;  // where there were candidates
};

// What a caller can have put together wrongly.
bool CheckInput(const IdentificationProblem& problem,
                const std::vector<Baseline>& baselines,
                const DamageAnalysisOptions& options, std::string* error) {
  if (!options.change.IsValid(error) ||
      !options.identification.IsValid(error) ||
      !options.identification.GivesIntervals(error) ||
      !options.search.IsValid(problem.dynamics->model(), error)) {
    return false;
  }
  if (baselines.empty()) {
    *error = "there is no baseline, expected at least one";
    return false;
  }
  const std::vector<std::string> groups = FreeGroups(*problem.dynamics);
  if (groups.empty()) {
    *error = "no group is free; free the groups that may have changed";
    return false;
  }
  return AreBaselinesOf(*problem.dynamics, baselines, error);
}

}  // namespace

bool AnalyseDamage(const IdentificationProblem& problem,
                   const IdentificationSummary& summary,
                   const IdentifiedModel& model,
                   const std::vector<Baseline>& baselines,
                   const DamageAnalysisOptions& options, DamageResult* result,
                   std::string* error) {
  const bool may_explain =
      !summary.usable() && summary.verdict.MissesMotionAlone();
  if (!(may_explain ? IsFitOf(problem, summary, model, error)
                    : IsUsableResultOf(problem, summary, model, error)) ||
      !CheckInput(problem, baselines, options, error)) {
    return false;
  }
  *result = DamageResult();
  return Analyst(problem, baselines, options, result)
      .Run(summary, model, error);
}

}  // namespace pinode
