#include "pinode/study/damage/change_explanations.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

// Number of single groups that are refitted, of each ranking.
constexpr size_t kMostSingleChanges = 4;
// Number of single groups that are refitted without a ranking.
constexpr int kAllSingleChanges = 16;
constexpr size_t kMostSetExchanges = 4;
// Number of additions that are refitted a round, and rounds.
constexpr size_t kMostAdditions = 2;
constexpr int kMostExtensions = 3;
// Part of the model's damping below which it cannot scale a change.
constexpr double kDampingNearlyGone = 0.1;
// Largest cost of the likeliest set in multiples of that with all that was
// found: a tenth more of the squares of the residuals.
constexpr double kMostCost = 1.1;
// Number of explanations to report.
constexpr size_t kMostListed = 6;

bool HasEntry(const std::vector<int>& list, int entry) {
  return std::find(list.begin(), list.end(), entry) != list.end();
}

bool IsSubset(const std::vector<int>& part, const std::vector<int>& whole) {
  return std::includes(whole.begin(), whole.end(), part.begin(), part.end());
}

std::vector<int> SetWith(std::vector<int> entries, int more) {
  entries.push_back(more);
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<int> SetWithout(std::vector<int> entries, int less) {
  entries.erase(std::remove(entries.begin(), entries.end(), less),
                entries.end());
  return entries;
}

// Returns the entries with the largest gains, the largest first.
std::vector<int> LargestGains(const Vector& gains, size_t most) {
  std::vector<int> order;
  for (int j = 0; j < gains.size(); ++j) {
    if (gains[j] > 0.0) order.push_back(j);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return gains[a] > gains[b]; });
  if (order.size() > most) order.resize(most);
  return order;
}

}  // namespace

ChangeExplanations::ChangeExplanations(
    ChangeRefitter* refitter, const std::vector<bool>& absolute,
    const std::vector<ChangeCandidate>& candidates, StatesOfBaselines states,
    BaselinesNear near, const ChangeOptions& options)
    : refitter_(*refitter),
      absolute_(absolute),
      candidates_(candidates),
      states_(std::move(states)),
      near_(std::move(near)),
      options_(options) {}

bool ChangeExplanations::ModelFor(
    const std::vector<ChangeCandidate>& candidates, ChangeModel* model) {
  std::vector<GroupState> states;
  PooledBaselines pooled;
  std::string unused;
  if (!states_(candidates, &states) ||
      !PoolBaselines(states, &pooled, &unused)) {
    return false;
  }
  between_ = between_ || pooled.between.maxCoeff() > 0.0;
  std::vector<bool> absolute = absolute_;
  for (const ChangeCandidate& candidate : candidates) {
    // A change of damping is a fraction of the baseline's.
    const double before =
        1.0 + pooled.state.values[static_cast<Eigen::Index>(absolute.size())];
    absolute.push_back(candidate.subject.kind != ChangeKind::kDamping ||
                       !(before > kDampingNearlyGone));
  }
  *model = ChangeModel(pooled, absolute);
  return true;
}

bool ChangeExplanations::Try(std::vector<int> entries, const Refit* from) {
  std::sort(entries.begin(), entries.end());
  if (refitter_.interrupted() ||
      std::find(tried_.begin(), tried_.end(), entries) != tried_.end()) {
    return false;
  }
  tried_.push_back(entries);
  Refit refit;
  refit.entries = entries;
  for (const int entry : entries) {
    if (entry < num_groups()) {
      refit.changed.push_back(entry);
      continue;
    }
    refit.changed.push_back(num_groups() +
                            static_cast<int>(refit.candidates.size()));
    refit.candidates.push_back(
        candidates_[static_cast<size_t>(entry - num_groups())]);
  }
  ChangeModel model;
  const std::map<std::string, double>* begin =
      from != nullptr ? &from->fit.parameters : nullptr;
  if (!ModelFor(refit.candidates, &model) ||
      !refitter_.Refit(model, refit.candidates, refit.changed,
                       refit.candidates.empty() ? near_ : nullptr, begin,
                       &refit.fit)) {
    return false;
  }
  const double possible =
      static_cast<double>(absolute_.size() + candidates_.size());
  refit.log_odds = refit.fit.posterior.log_evidence -
                   static_cast<double>(entries.size()) * std::log(possible);
  if (!std::isfinite(refit.log_odds)) return false;
  refits_.push_back(std::move(refit));
  return true;
}

const ChangeExplanations::Refit* ChangeExplanations::Find(
    std::vector<int> entries) const {
  std::sort(entries.begin(), entries.end());
  for (const Refit& refit : refits_) {
    if (refit.entries == entries) return &refit;
  }
  return nullptr;
}

const ChangeExplanations::Refit* ChangeExplanations::Best() const {
  const Refit* best = nullptr;
  for (const Refit& refit : refits_) {
    if (!refit.entries.empty() &&
        (best == nullptr || refit.log_odds > best->log_odds)) {
      best = &refit;
    }
  }
  return best;
}

// Largest family-wise rate at which a gain in log-likelihood by one more change
// is no chance (Bonferroni).
double ChangeExplanations::FamilyWise(double gain) const {
  const double possible =
      static_cast<double>(absolute_.size() + candidates_.size());
  return std::min(1.0, possible * std::erfc(std::sqrt(std::max(gain, 0.0))));
}

void ChangeExplanations::TrySingles(bool thorough) {
  std::vector<int> singles;
  const auto add = [&singles](const std::vector<int>& more) {
    for (const int j : more) {
      if (!HasEntry(singles, j)) singles.push_back(j);
    }
  };
  ChangeModel model;
  ComparedCost all_free;
  if (!ModelFor({}, &model)) return;
  const size_t most = thorough && num_groups() <= kAllSingleChanges
                          ? static_cast<size_t>(kAllSingleChanges)
                          : kMostSingleChanges;
  if (Try({}, nullptr)) {
    const ChangeRefit& nothing = Find({})->fit;
    add(LargestGains(nothing.model.GainsOf(nothing.cost, {}), most));
  }
  if (refitter_.AllFree(&all_free)) {
    add(LargestGains(model.GainsOf(all_free, {}), most));
  }
  for (const int j : singles) Try({j}, nullptr);
}

double ChangeExplanations::LeastNeeded(const Refit& refit, int* entry) {
  double largest = 0.0;
  const ChangeModel& model = refit.fit.model;
  for (size_t k = 0; k < refit.entries.size(); ++k) {
    const Refit* without = Find(SetWithout(refit.entries, refit.entries[k]));
    const double cost =
        without != nullptr
            ? without->fit.posterior.cost
            : model
                  .PosteriorOf(refit.fit.cost,
                               SetWithout(refit.changed, refit.changed[k]))
                  .cost;
    const double p = FamilyWise(cost - refit.fit.posterior.cost);
    if (p >= largest) {
      largest = p;
      *entry = refit.entries[k];
    }
  }
  return largest;
}

std::vector<int> ChangeExplanations::NeededOf(const Refit& refit) const {
  const ChangeModel& model = refit.fit.model;
  std::vector<int> entries = refit.entries;
  std::vector<int> changed = refit.changed;
  double cost = refit.fit.posterior.cost;
  while (!entries.empty()) {
    size_t least = 0;
    double least_cost = kInfinity;
    for (size_t k = 0; k < entries.size(); ++k) {
      const double without =
          model.PosteriorOf(refit.fit.cost, SetWithout(changed, changed[k]))
              .cost;
      if (without < least_cost) {
        least = k;
        least_cost = without;
      }
    }
    if (FamilyWise(least_cost - cost) <= options_.false_alarm_rate) break;
    cost = least_cost;
    entries = SetWithout(entries, entries[least]);
    changed = SetWithout(changed, changed[least]);
  }
  return entries;
}

void ChangeExplanations::Extend() {
  for (int round = 0; round < kMostExtensions; ++round) {
    const Refit* found = Best();
    if (found == nullptr) return;
    const Refit best = *found;
    const ChangeModel& model = best.fit.model;
    const Vector gains =
        model.GainsOf(best.fit.cost, best.changed).head(num_groups());
    for (const int j : LargestGains(gains, kMostAdditions)) {
      if (between_ || FamilyWise(gains[j]) > options_.false_alarm_rate) break;
      Try(SetWith(best.entries, j), &best);
    }
    // Exchanges in a set of several, and those that a newcomer makes needless.
    for (size_t k = 0; best.entries.size() > 1 && k < best.entries.size();
         ++k) {
      const std::vector<int> rest = SetWithout(best.changed, best.changed[k]);
      const Vector instead =
          model.GainsOf(best.fit.cost, rest).head(num_groups());
      for (const int j : LargestGains(instead, kMostAdditions)) {
        if (HasEntry(best.entries, j)) continue;
        Try(SetWith(SetWithout(best.entries, best.entries[k]), j), &best);
      }
    }
    int needless = -1;
    if (best.entries.size() > 1 &&
        LeastNeeded(best, &needless) > options_.false_alarm_rate) {
      Try(SetWithout(best.entries, needless), &best);
    }
    if (Best()->entries == best.entries) return;
  }
}

bool ChangeExplanations::Run(const std::vector<int>& found,
                             const std::vector<std::pair<int, int>>& exchanges,
                             bool thorough, ExplainedChange* result) {
  TrySingles(thorough);
  Try(found, nullptr);
  const Refit* own = Find(found);
  if (own == nullptr) return false;
  const Refit from = *own;
  const std::vector<int> needed = NeededOf(from);
  if (!needed.empty()) Try(needed, &from);
  size_t count = 0;
  for (const auto& [one, other] : exchanges) {
    if (++count > kMostSetExchanges) break;
    Try(SetWith(SetWithout(found, one), other), &from);
  }
  Extend();
  if (refitter_.interrupted()) return false;
  // None of the sets stands for all that was found.
  if (Best() == nullptr ||
      Best()->fit.cost.cost > kMostCost * refitter_.cost_with_all()) {
    return false;
  }
  Report(result);
  return !result->explanations.empty();
}

void ChangeExplanations::Report(ExplainedChange* result) {
  // Sets whose changes are all needed, and the likeliest of all: beside that,
  // one whose changes are all needed may describe next to nothing.
  std::vector<const Refit*> needed;
  for (const Refit& refit : refits_) {
    int unused = -1;
    if (refit.entries.empty()) continue;
    if (refit.entries.size() == 1 || between_ || &refit == Best() ||
        LeastNeeded(refit, &unused) <= options_.false_alarm_rate) {
      needed.push_back(&refit);
    }
  }
  std::vector<const Refit*> listed;
  for (const Refit* refit : needed) {
    const bool contained =
        std::any_of(needed.begin(), needed.end(), [&](const Refit* other) {
          return other != refit && IsSubset(refit->entries, other->entries);
        });
    if (!contained) listed.push_back(refit);
  }
  if (listed.empty()) return;
  std::stable_sort(
      listed.begin(), listed.end(),
      [](const Refit* a, const Refit* b) { return a->log_odds > b->log_odds; });
  double sum = 0.0;
  for (const Refit* refit : listed) {
    sum += std::exp(refit->log_odds - listed[0]->log_odds);
  }
  const Refit* nothing = Find({});
  for (const Refit* refit : listed) {
    ChangeExplanation explanation;
    explanation.log_odds = refit->log_odds - listed[0]->log_odds;
    explanation.probability = std::exp(explanation.log_odds) / sum;
    if (-2.0 * explanation.log_odds > options_.rival_loss ||
        result->explanations.size() == kMostListed) {
      break;
    }
    const ChangeModel& model = refit->fit.model;
    explanation.changed = refit->entries;
    explanation.changes = model.ChangesOf(refit->fit.posterior, refit->changed,
                                          options_.threshold);
    for (size_t k = 0; k < refit->entries.size(); ++k) {
      const Refit* without =
          Find(SetWithout(refit->entries, refit->entries[k]));
      if (without == nullptr && refit->entries.size() == 1) without = nothing;
      const double cost =
          without != nullptr
              ? without->fit.posterior.cost
              : model
                    .PosteriorOf(refit->fit.cost,
                                 SetWithout(refit->changed, refit->changed[k]))
                    .cost;
      explanation.changes[k].p_value =
          FamilyWise(cost - refit->fit.posterior.cost);
    }
    result->explanations.push_back(std::move(explanation));
  }
  // The others beside the first.
  const Refit& first = *listed[0];
  const ChangeModel& model = first.fit.model;
  const Vector gains = model.GainsOf(first.fit.cost, first.changed);
  for (int j = 0; j < num_groups(); ++j) {
    std::vector<int> with = first.changed;
    if (!HasEntry(with, j)) with.push_back(j);
    const std::vector<GroupChange> changes = model.ChangesOf(
        model.PosteriorOf(first.fit.cost, with), with, options_.threshold);
    GroupChange change = changes.back();
    if (HasEntry(first.changed, j)) {
      const auto at = std::find(with.begin(), with.end(), j) - with.begin();
      change = result->explanations[0].changes[static_cast<size_t>(at)];
    } else {
      change.changed = false;
      change.p_value = FamilyWise(gains[j]);
    }
    result->groups.push_back(change);
  }
}

}  // namespace pinode
