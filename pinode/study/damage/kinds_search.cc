#include "pinode/study/damage/kinds_search.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/damage/linear_causes.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

// A cause that is found may change the others.
constexpr int kMaxRounds = 3;

using Candidates = std::vector<ChangeCandidate>;

bool Has(const Candidates& candidates, const ChangeCandidate& candidate) {
  return std::any_of(candidates.begin(), candidates.end(),
                     [&](const ChangeCandidate& other) {
                       return other.subject.name == candidate.subject.name;
                     });
}

}  // namespace

ChangeOptions OptionsFor(const ChangeOptions& given, size_t num_groups,
                         const Candidates& candidates, double rate) {
  ChangeOptions options = given;
  options.false_alarm_rate = rate;
  options.absolute.assign(num_groups, false);
  for (const ChangeCandidate& candidate : candidates) {
    // A change of damping or stiffness is a fraction of the baseline's.
    options.absolute.push_back(candidate.subject.kind == ChangeKind::kMass ||
                               candidate.subject.kind ==
                                   ChangeKind::kNonlinear);
  }
  return options;
}

Candidates Without(const Candidates& all, const Candidates& taken) {
  Candidates rest;
  for (const ChangeCandidate& candidate : all) {
    if (!Has(taken, candidate)) rest.push_back(candidate);
  }
  return rest;
}

KindsSearch::KindsSearch(const std::vector<std::string>& groups,
                         const ChangeOptions& options,
                         const IdentificationOptions& identification,
                         HealthyRecords* healthy_records, InnerFit* inner,
                         const FitOfRecords& fit_of_groups,
                         std::vector<ChangeCandidate> candidates)
    : groups_(groups),
      options_(options),
      identification_(identification),
      healthy_records_(*healthy_records),
      inner_(*inner),
      fit_of_groups_(fit_of_groups),
      candidates_(std::move(candidates)),
      fit_of_new_(fit_of_groups_) {}

bool KindsSearch::Run(const std::vector<Explanation>& explanations, bool usable,
                      std::string* error) {
  return healthy_records_.Refit(&inner_, error) &&
         LookForKinds(explanations, usable, error) && LookForDampers(error);
}

// For groups and all candidates, of which changes of logarithms are taken.
ChangeOptions KindsSearch::WideOptions(double rate) const {
  ChangeOptions options =
      OptionsFor(options_, groups_.size(), candidates_, rate);
  options.absolute.assign(options.absolute.size(), true);
  return options;
}

// Groups and all candidates of the healthy records and the new ones.
bool KindsSearch::WideStates(std::string* error) {
  if (!healthy_records_.States(fit_of_new_, candidates_, &healthy_, error) ||
      !StateNear(fit_of_new_, groups_, candidates_, identification_.num_threads,
                 &current_, error)) {
    return false;
  }
  healthy_.push_back(std::move(current_));
  is_logarithm_ = ToLogarithms(groups_.size(), candidates_, &healthy_);
  current_ = std::move(healthy_.back());
  healthy_.pop_back();
  return true;
}

// found_ and fit_of_new_, where masses or nonlinear forces are among what the
// data ask for.
bool KindsSearch::LookForKinds(const std::vector<Explanation>& explanations,
                               bool usable, std::string* error) {
  // Far from what explains the new records no linearisation finds it: damping
  // that had grown by 40 % left 20 % unexplained, and "cannot tell", with 7
  // masses and 6 factors on damping as candidates.
  const Candidates explained = ExplainedCandidates(explanations, candidates_);
  bool explains = !explained.empty() && FitWith(explained, error);
  if (interrupted_) return false;
  error->clear();
  for (int round = 0; round < kMaxRounds; ++round) {
    ChangeEstimate wide;
    if (!WideStates(error) ||
        !EstimateChange(healthy_, current_,
                        WideOptions(kShareOfKinds * options_.false_alarm_rate),
                        &wide, error)) {
      return false;
    }
    Candidates asked_for;
    for (size_t j = 0; j < candidates_.size(); ++j) {
      if (wide.groups[groups_.size() + j].changed) {
        asked_for.push_back(candidates_[j]);
      }
    }
    for (ChangeCandidate& candidate : Without(in_both_, asked_for)) {
      asked_for.push_back(std::move(candidate));
    }
    if (Without(asked_for, found_).empty() &&
        Without(found_, asked_for).empty()) {
      return true;
    }
    // Without what was found the motion has no explanation at all.
    if (asked_for.empty() && !usable) return true;
    if (!FitWith(asked_for, error)) {
      if (!explains) return false;
      // An explanation of the records alone needs nothing beside it.
      error->clear();
      return true;
    }
    explains = false;
  }
  return true;
}

// Dampers, where motion is left unexplained: at the places of the nonlinear
// forces that were found and instead of them, or at one of few springs. Those
// that leave least are taken if it is less than half.
bool KindsSearch::LookForDampers(std::string* error) {
  const double missed = MissedOf(fit_of_new_.summary, 0.0);
  if (!(missed > limits::kNotedUnexplained)) return true;
  const State begin{found_, fit_of_new_};
  std::optional<State> best;
  double least = 0.5 * missed;
  std::string unused;
  for (const Candidates& dampers : DampersToTry(
           fit_of_groups_.problem.dynamics->model(), found_, candidates_)) {
    Return(begin);
    const bool fits = FitNewWith(dampers, &unused);
    if (interrupted_) {
      *error = "interrupted";
      return false;
    }
    const double left = MissedOf(fit_of_new_.summary, 0.0);
    if (!fits || !(left < least) || IsDrivenByDamping()) continue;
    least = left;
    best = State{found_, fit_of_new_};
  }
  Return(best.has_value() ? *best : begin);
  if (best.has_value() && !TakeDampers()) Return(begin);
  return true;
}

// Makes the dampers of found_ candidates. False, with all as it was except
// found_ and fit_of_new_, where the states with them are not finite.
bool KindsSearch::TakeDampers() {
  const Candidates before = candidates_;
  const std::vector<FitOfRecords> fits = healthy_records_.fits();
  std::vector<GroupState> healthy = healthy_;
  GroupState current = current_;
  const std::vector<bool> is_logarithm = is_logarithm_;
  const Candidates dampers = Without(found_, candidates_);
  candidates_.insert(candidates_.end(), dampers.begin(), dampers.end());
  RefitBaselines();
  std::string unused;
  if (!WideStates(&unused)) {
    candidates_ = before;
    healthy_records_.Restore(fits);
    healthy_ = std::move(healthy);
    current_ = std::move(current);
    is_logarithm_ = is_logarithm;
    return false;
  }
  return true;
}

bool KindsSearch::IsDrivenByDamping() const {
  const StructuralDynamics& dynamics = *fit_of_new_.problem.dynamics;
  return HasNegativeDamping(
      dynamics
          .CorrectedModel(
              fit_of_new_.model.parameters.head(dynamics.num_parameters()))
          .damping);
}

void KindsSearch::Return(const State& state) {
  found_ = state.found;
  fit_of_new_ = state.fit;
}

// Takes `candidates` for found_ and fits the new records with them, and the
// baselines that they explain.
bool KindsSearch::FitWith(const Candidates& candidates, std::string* error) {
  if (!FitNewWith(candidates, error)) return false;
  RefitBaselines();
  return true;
}

// Takes `candidates` for found_ and fits the new records alone with them.
bool KindsSearch::FitNewWith(const Candidates& candidates, std::string* error) {
  FitOfRecords fit;
  fit.name = fit_of_groups_.name;
  if (!AddCandidates(fit_of_groups_.problem, candidates, &fit.problem, error)) {
    return false;
  }
  IdentificationOptions options = identification_;
  BeginNearTheEnd(&options);
  options.max_num_iterations =
      std::min(options.max_num_iterations, kMostIterationsWithKinds);
  const IdentifiedModel begin =
      BeginFrom(ParametersByName(fit_of_new_.problem, fit_of_new_.model),
                fit_of_new_.model, fit.problem);
  inner_.Run("with " + std::to_string(candidates.size()) + " more", fit.problem,
             options, &begin, &fit.summary, &fit.model);
  interrupted_ = fit.summary.termination == Termination::kInterrupted;
  const std::string why_not = WhyNotSound(options.tuning.gaps, fit.summary);
  if (!why_not.empty() || fit.summary.covariance.size() == 0) {
    *error =
        "the fit with " +
        (candidates.empty() ? "groups alone" : candidates[0].subject.name) +
        (candidates.size() > 1 ? " and others" : "") + " is not usable: " +
        (why_not.empty() ? "it has no covariance" : why_not);
    return false;
  }
  found_ = candidates;
  fit_of_new_ = std::move(fit);
  return true;
}

void KindsSearch::RefitBaselines() {
  // Candidates that leave motion unexplained are not what the model lacks.
  if (MissedOf(fit_of_new_.summary, 0.0) < limits::kNotedUnexplained &&
      healthy_records_.RefitWith(
          found_, ParametersByName(fit_of_new_.problem, fit_of_new_.model),
          &inner_)) {
    in_both_ = found_;
  }
}

}  // namespace pinode
