#include "pinode/estimate/shooting/look_ahead.h"

#include <algorithm>

namespace pinode {

bool LookAhead::GoesAlong(int num_sweeps,
                          const std::vector<StartProgress>& searches,
                          double linearized_cost) const {
  if (num_sweeps == 0) return goes_first_;
  if (num_sweeps != 1 || promised_.empty() || bend_.size() != searches.size()) {
    return false;
  }
  // From one step of a fit to the next `bend_` changes by a factor of two or
  // so.
  constexpr double kCaution = 3.0;
  double cost = 0.0;
  for (size_t r = 0; r < searches.size(); ++r) {
    const StartProgress& search = searches[r];
    if (kCaution * bend_[r] * promised_[r] * promised_[r] >
        search.last_promise) {
      return false;
    }
    cost += search.cost - promised_[r];
  }
  // Steps of a fit that lead uphill are mostly rejected.
  return cost < linearized_cost;
}

void LookAhead::Learn(int num_sweeps,
                      const std::vector<StartProgress>& searches) {
  const auto all = [&searches](auto what) {
    return std::all_of(searches.begin(), searches.end(), what);
  };
  const bool at_trial =
      all([](const StartProgress& search) { return search.is_at_trial; });
  if (num_sweeps == 1) {
    promised_.clear();
    if (!at_trial ||
        !all([](const StartProgress& search) { return !search.done; })) {
      return;
    }
    for (const StartProgress& search : searches) {
      promised_.push_back(search.promise);
    }
  } else if (num_sweeps == 2 && at_trial && !promised_.empty()) {
    bend_.clear();
    for (size_t r = 0; r < searches.size(); ++r) {
      bend_.push_back(searches[r].promise / (promised_[r] * promised_[r]));
    }
  }
}

}  // namespace pinode
