#include "pinode/discover/support_window.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

// Search of the window, the best supports first.
class Window {
 public:
  Window(const QuadraticCost& cost, const StepwiseOptions& options,
         double window)
      : options_(options),
        scales_(UnitDiagonalScales(cost)),
        cost_(ScaledCost(cost, scales_)),
        window_(window) {}

  // The first one is the start. Solves for the values alone: a face of many
  // supports would take long.
  void Add(const std::vector<int>& support) {
    const Vector gradient = cost_.gradient(support);
    const Matrix hessian = cost_.hessian(support, support);
    const Vector solution = -hessian.ldlt().solve(gradient);
    double criterion = gradient.dot(solution);
    for (const int j : support) criterion += options_.prices[j];
    const bool allowed = IsAllowed(support, solution);
    const bool start = found_.empty();
    if (!found_.emplace(support, Entry{criterion, allowed, start, false})
             .second) {
      return;
    }
    if (allowed) best_ = std::min(best_, criterion);
  }

  void Run(int most_expanded) {
    for (int k = 0; k < most_expanded; ++k) {
      const auto next = Next();
      if (next == found_.end()) return;
      next->second.expanded = true;
      Expand(QuadraticFace(cost_, next->first), next->second.criterion);
    }
  }

  std::vector<WeighedSupport> Sorted(const std::vector<int>& start) const {
    std::vector<WeighedSupport> sorted;
    for (const auto& [support, entry] : found_) {
      if (support == start ||
          (entry.allowed && entry.criterion <= best_ + window_)) {
        sorted.push_back({support, entry.criterion});
      }
    }
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const WeighedSupport& a, const WeighedSupport& b) {
                       return a.criterion < b.criterion;
                     });
    return sorted;
  }

 private:
  struct Entry {
    double criterion;
    bool allowed;  // every value has an allowed sign and size
    bool start;
    bool expanded;
  };
  using Found = std::map<std::vector<int>, Entry>;

  bool Optional(int j) const {
    return options_.optional[static_cast<size_t>(j)];
  }

  bool IsAllowed(const std::vector<int>& support,
                 const Vector& solution) const {
    for (size_t a = 0; a < support.size(); ++a) {
      if (Optional(support[a]) &&
          !IsAllowedValue(options_, scales_, support[a],
                          solution[static_cast<Eigen::Index>(a)])) {
        return false;
      }
    }
    return true;
  }

  Found::iterator Next() {
    auto next = found_.end();
    for (auto entry = found_.begin(); entry != found_.end(); ++entry) {
      if (entry->second.expanded) continue;
      // Every search leaves from the start, allowed or not.
      if (entry->second.start) return entry;
      if (!entry->second.allowed || entry->second.criterion > best_ + window_) {
        continue;
      }
      if (next == found_.end() ||
          entry->second.criterion < next->second.criterion) {
        next = entry;
      }
    }
    return next;
  }

  // Adds the neighbours of a support that lie in the window.
  void Expand(const QuadraticFace& face, double here) {
    const std::vector<int>& support = face.support();
    for (Eigen::Index a = -1; a < static_cast<Eigen::Index>(support.size());
         ++a) {
      std::vector<int> rest = support;
      double without = here;
      if (a >= 0) {
        const int i = support[static_cast<size_t>(a)];
        if (!Optional(i)) continue;
        rest.erase(rest.begin() + a);
        without += face.Loss(a) - options_.prices[i];
        if (without <= best_ + window_) Add(rest);
      }
      for (int j = 0; j < static_cast<int>(cost_.gradient.size()); ++j) {
        if (std::binary_search(support.begin(), support.end(), j)) continue;
        double value;
        const double gain = face.Gain(j, a, &value);
        if (gain <= 0.0 ||
            without - gain + options_.prices[j] > best_ + window_) {
          continue;
        }
        std::vector<int> changed = rest;
        changed.insert(std::lower_bound(changed.begin(), changed.end(), j), j);
        Add(changed);
      }
    }
  }

  const StepwiseOptions& options_;
  const Vector scales_;
  const QuadraticCost cost_;
  const double window_;
  Found found_;
  double best_ = kInfinity;  // of those allowed
};

}  // namespace

std::vector<WeighedSupport> SupportsWithin(const QuadraticCost& cost,
                                           const StepwiseOptions& options,
                                           const std::vector<int>& start,
                                           double window, int most_expanded) {
  std::vector<bool> taken(static_cast<size_t>(cost.gradient.size()));
  for (size_t j = 0; j < taken.size(); ++j) taken[j] = !options.optional[j];
  for (const int j : start) taken[static_cast<size_t>(j)] = true;
  std::vector<int> support;
  for (size_t j = 0; j < taken.size(); ++j) {
    if (taken[j]) support.push_back(static_cast<int>(j));
  }
  Window search(cost, options, window);
  search.Add(support);
  for (const int i : support) {
    if (options.optional[static_cast<size_t>(i)]) {
      search.Add(SelectWithout(cost, options, support, i));
    }
  }
  search.Run(most_expanded);
  return search.Sorted(support);
}

}  // namespace pinode
