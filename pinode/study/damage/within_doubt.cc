#include "pinode/study/damage/within_doubt.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

// True if another value of a change is one beyond the threshold as well.
bool IsLikeChange(double moved, const ExplainedValue& other, double threshold) {
  return moved < 0.0 ? other.upper95 < -threshold : other.lower95 > threshold;
}
double ValueOf(const std::vector<ExplainedValue>& values,
               const std::string& name) {
  for (const ExplainedValue& value : values) {
    if (value.name == name) return value.value;
  }
  return kNaN;
}
// How far an estimate may be off to either side; nothing where there is none.
ExplainedValue OffsetsOf(const std::vector<ExplainedValue>& values,
                         const std::string& name) {
  for (const ExplainedValue& value : values) {
    if (value.name != name) continue;
    return {name, 0.0, value.lower95 - value.value,
            value.upper95 - value.value};
  }
  return {name, 0.0, 0.0, 0.0};
}

// Returns how far a group that has `moved` has moved if one explanation of
// what the model lacks holds for the healthy records and the new ones;
// nothing where there is none that explains both.
std::optional<ExplainedValue> MovedUnderOne(const Doubts& healthy,
                                            const Doubts& current,
                                            const std::string& name,
                                            double moved) {
  const std::optional<Explanation>& then = healthy.whole;
  const std::optional<Explanation>& now = current.whole;
  if (!then || !now || then->kind != now->kind || then->place != now->place) {
    return std::nullopt;
  }
  const ExplainedValue from = OffsetsOf(then->values, name);
  const ExplainedValue to = OffsetsOf(now->values, name);
  const double shift =
      ValueOf(now->values, name) - ValueOf(current.reach, name) -
      ValueOf(then->values, name) + ValueOf(healthy.reach, name);
  const double half_width = std::hypot(from.upper95, to.upper95);
  if (!std::isfinite(shift) || !std::isfinite(half_width)) {
    return std::nullopt;
  }
  const double value = moved + shift;
  return ExplainedValue{name, value, value - half_width, value + half_width};
}

void Widen(const GroupState& state, size_t j, ExplainedValue* offsets) {
  const auto i = static_cast<Eigen::Index>(j);
  offsets->upper95 = 1.96 * std::sqrt(std::max(state.covariance(i, i), 0.0));
  offsets->lower95 = -offsets->upper95;
}

// Factor from the change of group `j` to its move.
double ScaleOf(const GroupState& before, const ChangeOptions& options,
               size_t j) {
  return options.absolute[j]
             ? 1.0
             : 1.0 + before.values[static_cast<Eigen::Index>(j)];
}

}  // namespace

std::vector<bool> WithinDoubt(const DoubtedState& then, const DoubtedState& now,
                              const std::vector<std::string>& groups,
                              const std::vector<ChangeSubject>& subjects,
                              const ChangeEstimate& estimate,
                              const ChangeOptions& options) {
  std::vector<bool> within(subjects.size(), false);
  const std::vector<ExplainedValue>& reach_then = then.doubts.reach;
  const std::vector<ExplainedValue>& reach_now = now.doubts.reach;
  const bool any_doubt = !reach_then.empty() || !reach_now.empty();
  for (size_t j = 0; j < groups.size(); ++j) {
    const double scale = ScaleOf(then.state, options, j);
    const double moved = scale * estimate.groups[j].change;
    if (const std::optional<ExplainedValue> under =
            MovedUnderOne(then.doubts, now.doubts, groups[j], moved)) {
      within[j] = !IsLikeChange(moved, *under, options.threshold * scale);
      continue;
    }
    ExplainedValue offsets_then = OffsetsOf(reach_then, groups[j]);
    ExplainedValue offsets_now = OffsetsOf(reach_now, groups[j]);
    // One that is in no doubt has its interval beside the other's reach.
    if (any_doubt && reach_then.empty()) Widen(then.state, j, &offsets_then);
    if (any_doubt && reach_now.empty()) Widen(now.state, j, &offsets_now);
    within[j] = moved >= offsets_then.lower95 - offsets_now.upper95 &&
                moved <= offsets_then.upper95 - offsets_now.lower95;
  }
  // The healthy fit has no value of masses and of what is in no group, and
  // held them to be as in the model.
  for (size_t j = groups.size(); j < within.size(); ++j) {
    const ChangeKind kind = subjects[j].kind;
    if (kind != ChangeKind::kStiffness && kind != ChangeKind::kMass) continue;
    const ExplainedValue offsets = OffsetsOf(reach_now, subjects[j].name);
    const double moved = estimate.groups[j].change;
    within[j] = (kind == ChangeKind::kStiffness && now.misses_motion) ||
                (moved >= -offsets.upper95 && moved <= -offsets.lower95);
  }
  return within;
}

std::vector<ExplainedValue> ChangesUnderOne(
    const DoubtedState& then, const Doubts& now,
    const std::vector<std::string>& groups, const ChangeEstimate& estimate,
    const ChangeOptions& options) {
  std::vector<ExplainedValue> changes;
  for (size_t j = 0; j < groups.size(); ++j) {
    const double scale = ScaleOf(then.state, options, j);
    const std::optional<ExplainedValue> moved = MovedUnderOne(
        then.doubts, now, groups[j], scale * estimate.groups[j].change);
    if (!moved) return {};
    changes.push_back({groups[j], moved->value / scale, moved->lower95 / scale,
                       moved->upper95 / scale});
  }
  return changes;
}

}  // namespace pinode
