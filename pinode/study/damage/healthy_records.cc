#include "pinode/study/damage/healthy_records.h"

#include <cmath>
#include <utility>

#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/problem/growth.h"

namespace pinode {

HealthyRecords::HealthyRecords(const std::vector<Baseline>& baselines,
                               const IdentificationProblem& problem,
                               const std::vector<std::string>& groups,
                               const IdentificationOptions& options)
    : baselines_(baselines),
      groups_(groups),
      options_(options),
      held_(baselines, problem) {}

bool HealthyRecords::Refit(InnerFit* inner, std::string* error) {
  for (const Baseline& baseline : baselines_) {
    if (baseline.fit == nullptr) {
      *error = baseline.why_no_fit;
      return false;
    }
    const HealthyFit& healthy = *baseline.fit;
    FitOfRecords fit{baseline.name, healthy.problem, healthy.summary,
                     healthy.model};
    if (!healthy.IsFitted()) {
      IdentificationOptions options = healthy.options;
      options.num_threads = options_.num_threads;
      options.communicator = options_.communicator;
      BeginNearTheEnd(&options);
      inner->Run("baseline", fit.problem, options, nullptr, &fit.summary,
                 &fit.model);
      // No better than before, so not "usable".
      if (fit.summary.termination != Termination::kConverged) {
        *error = baseline.name + ": " + fit.summary.message;
        return false;
      }
    }
    fits_.push_back(std::move(fit));
  }
  return true;
}

bool HealthyRecords::RefitWith(const std::vector<ChangeCandidate>& found,
                               const std::map<std::string, double>& values,
                               InnerFit* inner) {
  // Five deviations, and as much as each unknown takes by chance.
  constexpr double kLeastPromise = 12.5;
  // The part of the unexplained motion that may be left. Wrong candidates leave
  // half of it; what the model lacks, nothing.
  constexpr double kMostLeft = 0.3;
  bool is_any = false;
  for (FitOfRecords& fit : fits_) {
    double promise = 0.0;
    FitOfRecords with;
    IdentifiedModel begin;
    std::string unused;
    if (!PromiseOf(fit, found, options_.num_threads, &promise, &unused) ||
        promise < kLeastPromise + 0.5 * static_cast<double>(found.size()) ||
        !WithCandidates(fit, found, &with.problem, &begin, &unused)) {
      continue;
    }
    with.name = fit.name;
    std::map<std::string, double> start =
        ParametersByName(fit.problem, fit.model);
    for (const ChangeCandidate& candidate : found) {
      const auto value = values.find(candidate.subject.name);
      if (value != values.end()) start.insert(*value);
    }
    IdentificationOptions options = options_;
    BeginNearTheEnd(&options);
    options.max_num_iterations =
        std::min(options.max_num_iterations, kMostIterationsWithKinds);
    // From where the new records have it, then from nothing.
    for (const IdentifiedModel& from :
         {BeginFrom(start, fit.model, with.problem), begin}) {
      inner->Run("baseline, with the changes found", with.problem, options,
                 &from, &with.summary, &with.model);
      if (WhyNotSound(options.tuning.gaps, with.summary).empty() &&
          MissedOf(with.summary, 0.0) <
              kMostLeft * MissedOf(fit.summary, 0.0)) {
        fit = std::move(with);
        is_any = true;
        break;
      }
      if (with.summary.termination == Termination::kInterrupted) return is_any;
    }
  }
  return is_any;
}

bool HealthyRecords::LeavesMotion(size_t baseline) const {
  const Baseline& own = baselines_[baseline];
  if (baseline < fits_.size() && own.fit != nullptr &&
      fits_[baseline].problem.dynamics != own.fit->problem.dynamics) {
    return MissedOf(fits_[baseline].summary, 0.0) > limits::kLittleUnexplained;
  }
  return own.doubts.misses_motion;
}

bool HealthyRecords::States(const FitOfRecords& of_new,
                            const std::vector<ChangeCandidate>& candidates,
                            std::vector<GroupState>* states,
                            std::string* error) {
  if (!candidates.empty()) return StatesNear(of_new, candidates, states, error);
  if (!FindSlopes(of_new, {}, error)) return false;
  states->clear();
  for (const Baseline& baseline : baselines_) {
    states->push_back(held_.empty() ? baseline.groups
                                    : held_.Compared(held_.StateOf(baseline),
                                                     groups_.size()));
  }
  return true;
}

bool HealthyRecords::StatesNear(const FitOfRecords& of_new,
                                const std::vector<ChangeCandidate>& candidates,
                                std::vector<GroupState>* states,
                                std::string* error) {
  Communicator& ranks = CommunicatorOrSingle(options_.communicator);
  states->assign(baselines_.size(), GroupState());
  std::vector<std::string> names = groups_;
  names.insert(names.end(), held_.names().begin(), held_.names().end());
  bool ok = FindSlopes(of_new, candidates, error);
  for (size_t i = 0; ok && i < baselines_.size(); ++i) {
    if (RankOfBaseline(i, ranks.size()) != ranks.rank()) continue;
    GroupState& state = (*states)[i];
    ok = StateNear(fits_[i], names, candidates, options_.num_threads, &state,
                   error);
    if (ok && !held_.empty()) state = held_.Compared(state, groups_.size());
  }
  if (ranks.size() == 1) return ok;
  if (!ranks.AllTrue(ok)) {
    // A rank whose own states are finite has no message yet.
    if (ok) *error = "the model with all kinds of change is not finite";
    return false;
  }
  return ExchangeStates(&ranks, states, error);
}

bool HealthyRecords::FindSlopes(const FitOfRecords& of_new,
                                const std::vector<ChangeCandidate>& candidates,
                                std::string* error) {
  return held_.empty() || held_.FindSlopes(of_new, groups_, candidates,
                                           options_.num_threads, error);
}

int HealthyRecords::RankOfBaseline(size_t i, int num_ranks) const {
  return static_cast<int>(i * static_cast<size_t>(num_ranks) /
                          baselines_.size());
}

bool HealthyRecords::ExchangeStates(Communicator* ranks,
                                    std::vector<GroupState>* states,
                                    std::string* error) const {
  for (size_t i = 0; i < states->size(); ++i) {
    GroupState& state = (*states)[i];
    const int owner = RankOfBaseline(i, ranks->size());
    Vector numbers(state.values.size() + state.covariance.size());
    numbers << state.values, state.covariance.reshaped();
    if (!ranks->Broadcast(owner, &numbers)) {
      *error = "a rank does not answer";
      return false;
    }
    // n + n^2 of them.
    const auto n = static_cast<Eigen::Index>(std::lround(
        std::sqrt(static_cast<double>(numbers.size()) + 0.25) - 0.5));
    state.values = numbers.head(n);
    state.covariance = numbers.tail(n * n).reshaped(n, n);
  }
  return true;
}

}  // namespace pinode
