#include "pinode/study/damage/loss_instead.h"

#include <algorithm>
#include <cstddef>
#include <map>

#include "pinode/damage/verdict.h"
#include "pinode/study/damage/change_candidates.h"
#include "pinode/study/damage/wide_state.h"

namespace pinode {
namespace {

// Entries of dampings, which may change beside a mass or a stiffness.
std::vector<int> DampingEntries(const ResultSubjects& all) {
  std::vector<int> entries;
  const size_t num_groups = all.num_groups();
  for (size_t j = 0; j < num_groups + all.candidates().size(); ++j) {
    const ChangeKind kind = j < num_groups
                                ? all.subjects()[j].kind
                                : all.candidates()[j - num_groups].subject.kind;
    if (kind == ChangeKind::kDamping) entries.push_back(static_cast<int>(j));
  }
  return entries;
}

}  // namespace

bool FindLossesInstead(const KindsSearch& kinds, const ChangeOptions& options,
                       ResultSubjects* subjects, std::vector<bool>* is_loss,
                       std::string* error) {
  const std::vector<ChangeSubject>& named = subjects->subjects();
  ChangeEstimate& estimate = *subjects->mutable_estimate();
  const std::vector<int> found = subjects->ChangedEntries();
  const std::vector<int> beside = DampingEntries(*subjects);
  const ChangeOptions wide = kinds.WideOptions(options.false_alarm_rate);
  const size_t num_groups = subjects->num_groups();
  is_loss->assign(named.size(), false);
  // The likeliest exchange for a mass, for each stiffness.
  std::map<size_t, ChangeInstead> likeliest;
  for (size_t m = 0; m < named.size(); ++m) {
    if (named[m].kind != ChangeKind::kMass || !estimate.groups[m].changed) {
      continue;
    }
    for (size_t j = 0; j < num_groups; ++j) {
      if (named[j].kind != ChangeKind::kStiffness || !kinds.is_logarithm()[j]) {
        continue;
      }
      ChangeInstead instead;
      if (!FindChangeInstead(kinds.healthy(), kinds.current(), wide, found,
                             subjects->EntryOf(m), static_cast<int>(j), beside,
                             &instead, error)) {
        return false;
      }
      FromLogarithm(options.threshold, 1.0, &instead.change);
      const bool is_beyond = instead.change.lower95 < -options.threshold;
      if (!is_beyond || !(instead.loss < options.rival_loss)) continue;
      GroupChange& own = estimate.groups[j];
      if (IsLostEitherWay(instead.change, &own)) continue;
      (*is_loss)[j] = true;
      instead.change.changed = own.changed;
      instead.change.p_value = own.p_value;
      if (!own.changed) {
        estimate.rivals.push_back(
            {static_cast<int>(m), static_cast<int>(j), instead.loss});
      }
      const auto [entry, is_new] = likeliest.try_emplace(j, instead);
      if (!is_new && instead.loss < entry->second.loss) {
        entry->second = instead;
      }
    }
  }
  for (const auto& [j, instead] : likeliest) {
    estimate.groups[j] = instead.change;
  }
  std::stable_sort(estimate.rivals.begin(), estimate.rivals.end(),
                   [](const RivalChange& a, const RivalChange& b) {
                     return a.loss < b.loss;
                   });
  return true;
}

bool IsLostEitherWay(const GroupChange& instead, GroupChange* own) {
  // Probability above which a loss is taken as certain, as in 95 % intervals.
  constexpr double kSure = 0.95;
  if (!own->changed ||
      !(std::min(own->probability, instead.probability) > kSure)) {
    return false;
  }
  own->lower95 = std::min(own->lower95, instead.lower95);
  own->upper95 = std::max(own->upper95, instead.upper95);
  return true;
}

}  // namespace pinode
