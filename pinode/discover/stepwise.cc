#include "pinode/discover/stepwise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Share of the price below which a gain is rounding. Otherwise an entry that
// has just come in for slightly more than its price would go and come for ever.
constexpr double kRounding = 1e-9;
// Number of entries that are held in by force: those that gain most.
constexpr int kMaxForced = 50;

// Exchange of one entry for another; -1: none.
struct Change {
  int out = -1;
  int in = -1;
  double gain = 0.0;  // in 2 f + prices of the entries
};

// Descent on 2 f + prices of the entries over supports.
class Descent {
 public:
  Descent(const QuadraticCost& cost, const StepwiseOptions& options)
      : options_(options),
        scales_(UnitDiagonalScales(cost)),
        cost_(ScaledCost(cost, scales_)),
        rounding_(kRounding * options.prices.lpNorm<Eigen::Infinity>()) {
    for (int j = 0; j < Count(); ++j) {
      if (!Optional(j)) required_.push_back(j);
    }
  }

  std::vector<int> Run(const std::vector<int>& start) const {
    QuadraticFace best = Descend(start, -1, -1);
    // Entries of the start may hide missing ones.
    Keep(Descend({}, -1, -1), &best);
    while (ImproveByForce(&best)) {
    }
    return best.support();
  }

  std::vector<int> Without(const std::vector<int>& start, int banned) const {
    return Descend(start, banned, -1).support();
  }

 private:
  int Count() const { return static_cast<int>(cost_.gradient.size()); }
  bool Optional(int j) const {
    return options_.optional[static_cast<size_t>(j)];
  }
  double Criterion(const QuadraticFace& face) const {
    double criterion = face.twice_cost();
    for (int j : face.support()) criterion += options_.prices[j];
    return criterion;
  }
  // True if all entries still have an allowed value: later entries may have
  // changed it.
  bool IsAllowed(const QuadraticFace& face) const {
    for (size_t a = 0; a < face.support().size(); ++a) {
      const int j = face.support()[a];
      const double value = face.solution()[static_cast<Eigen::Index>(a)];
      if (Optional(j) && !Allowed(j, value)) return false;
    }
    return true;
  }
  bool Keep(QuadraticFace face, QuadraticFace* best) const {
    const bool lower = Criterion(face) < Criterion(*best) - rounding_;
    if (!IsAllowed(face) || (IsAllowed(*best) && !lower)) return false;
    *best = std::move(face);
    return true;
  }

  // Removes one entry, else adds one, else exchanges one, as long as that
  // lowers the criterion. `banned` stays out, `locked` in; -1: none.
  QuadraticFace Descend(const std::vector<int>& start, int banned,
                        int locked) const {
    std::vector<bool> taken(static_cast<size_t>(Count()), false);
    for (int j : start) taken[static_cast<size_t>(j)] = true;
    for (int j : required_) taken[static_cast<size_t>(j)] = true;
    if (locked >= 0) taken[static_cast<size_t>(locked)] = true;
    if (banned >= 0 && Optional(banned)) {
      taken[static_cast<size_t>(banned)] = false;
    }
    QuadraticFace face(cost_, Entries(taken));
    // Each change lowers the criterion; the limit is for rounding alone.
    const int most_changes = 10 * Count() + 10;
    for (int change = 0; change < most_changes; ++change) {
      Change best = Leaving(face, locked);
      if (best.out < 0) best = Coming(face, taken, banned);
      if (best.in < 0 && best.out < 0) {
        best = Exchange(face, taken, banned, locked);
      }
      if (best.in < 0 && best.out < 0) break;
      if (best.out >= 0) taken[static_cast<size_t>(best.out)] = false;
      if (best.in >= 0) taken[static_cast<size_t>(best.in)] = true;
      face = QuadraticFace(cost_, Entries(taken));
    }
    return face;
  }

  // Holds one entry out, or in, against the criterion while the others are
  // chosen around it, and then releases it. If two entries do the work of one,
  // or one that of two, the first change between them is a loss.
  bool ImproveByForce(QuadraticFace* best) const {
    const QuadraticFace origin = *best;
    std::vector<bool> taken(static_cast<size_t>(Count()), false);
    for (int j : origin.support()) taken[static_cast<size_t>(j)] = true;
    bool improved = false;
    const auto attempt = [&](int banned, int locked) {
      const QuadraticFace forced = Descend(origin.support(), banned, locked);
      improved |= Keep(Descend(forced.support(), -1, -1), best);
    };
    for (int i : origin.support()) {
      if (Optional(i)) attempt(i, -1);
    }
    std::vector<std::pair<double, int>> gains;
    for (int j = 0; j < Count(); ++j) {
      if (taken[static_cast<size_t>(j)]) continue;
      double value;
      const double gain = origin.Gain(j, -1, &value);
      if (gain > 0.0 && Allowed(j, value)) {
        gains.emplace_back(options_.prices[j] - gain, j);
      }
    }
    std::sort(gains.begin(), gains.end());
    if (gains.size() > kMaxForced) gains.resize(kMaxForced);
    for (const auto& [loss, j] : gains) attempt(-1, j);
    return improved;
  }

  Change Leaving(const QuadraticFace& face, int locked) const {
    Change best;
    best.gain = rounding_;
    for (size_t a = 0; a < face.support().size(); ++a) {
      const int i = face.support()[a];
      if (!Optional(i) || i == locked) continue;
      const double gain =
          options_.prices[i] - face.Loss(static_cast<Eigen::Index>(a));
      if (gain > best.gain) best = {i, -1, gain};
    }
    return best;
  }

  Change Coming(const QuadraticFace& face, const std::vector<bool>& taken,
                int banned) const {
    Change best;
    for (int j = 0; j < Count(); ++j) {
      if (taken[static_cast<size_t>(j)] || j == banned) continue;
      double value;
      const double gain = face.Gain(j, -1, &value) - options_.prices[j];
      if (gain > best.gain && Allowed(j, value)) best = {-1, j, gain};
    }
    return best;
  }

  Change Exchange(const QuadraticFace& face, const std::vector<bool>& taken,
                  int banned, int locked) const {
    Change best;
    best.gain = rounding_;
    for (size_t a = 0; a < face.support().size(); ++a) {
      const int i = face.support()[a];
      if (!Optional(i) || i == locked) continue;
      const Eigen::Index row = static_cast<Eigen::Index>(a);
      const double loss = face.Loss(row) - options_.prices[i];
      for (int j = 0; j < Count(); ++j) {
        if (taken[static_cast<size_t>(j)] || j == banned) continue;
        double value;
        const double gain =
            face.Gain(j, row, &value) - options_.prices[j] - loss;
        if (gain > best.gain && Allowed(j, value)) best = {i, j, gain};
      }
    }
    return best;
  }

  bool Allowed(int j, double value) const {
    return IsAllowedValue(options_, scales_, j, value);
  }

  static std::vector<int> Entries(const std::vector<bool>& taken) {
    std::vector<int> entries;
    for (size_t j = 0; j < taken.size(); ++j) {
      if (taken[j]) entries.push_back(static_cast<int>(j));
    }
    return entries;
  }

  const StepwiseOptions& options_;
  const Vector scales_;
  const QuadraticCost cost_;
  const double rounding_;
  std::vector<int> required_;
};

void CheckSizes(const QuadraticCost& cost, const StepwiseOptions& options) {
  const size_t count = static_cast<size_t>(cost.gradient.size());
  CHECK_EQ(options.prices.size(), static_cast<Eigen::Index>(count));
  CHECK_EQ(options.optional.size(), count);
  CHECK_EQ(options.signs.size(), count);
  CHECK_EQ(options.smallest.size(), static_cast<Eigen::Index>(count));
}

}  // namespace

std::vector<int> SelectStepwise(const QuadraticCost& cost,
                                const StepwiseOptions& options,
                                const std::vector<int>& start) {
  CheckSizes(cost, options);
  return Descent(cost, options).Run(start);
}

std::vector<int> SelectWithout(const QuadraticCost& cost,
                               const StepwiseOptions& options,
                               const std::vector<int>& start, int banned) {
  CheckSizes(cost, options);
  return Descent(cost, options).Without(start, banned);
}

bool IsAllowedValue(const StepwiseOptions& options, const Vector& scales, int j,
                    double value) {
  return scales[j] * std::abs(value) >= options.smallest[j] &&
         options.signs[static_cast<size_t>(j)] * value >= 0.0;
}

Vector MinimizeOn(const QuadraticCost& cost, const std::vector<int>& support) {
  const Vector scales = UnitDiagonalScales(cost);
  const QuadraticFace face(ScaledCost(cost, scales), support);
  Vector theta = Vector::Zero(cost.gradient.size());
  for (size_t a = 0; a < support.size(); ++a) {
    const int j = support[a];
    theta[j] = scales[j] * face.solution()[static_cast<Eigen::Index>(a)];
  }
  return theta;
}

}  // namespace pinode
