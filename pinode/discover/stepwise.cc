#include "pinode/discover/stepwise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Largest remainder of a dependent column, as a share of its square, after
// projection on those taken.
constexpr double kDependent = 1e-9;
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

// Minimum over the entries of a support, of a cost that is scaled to a unit
// diagonal, with the values of 2 f after one more entry, one fewer, or both.
class Face {
 public:
  Face(const QuadraticCost& scaled, std::vector<int> support)
      : support_(std::move(support)) {
    const Eigen::Index size = static_cast<Eigen::Index>(support_.size());
    slopes_ = scaled.gradient;
    curvatures_ = scaled.hessian.diagonal();
    if (size == 0) return;
    Matrix rows(size, scaled.gradient.size());
    Matrix hessian(size, size);
    Vector gradient(size);
    for (Eigen::Index a = 0; a < size; ++a) {
      rows.row(a) = scaled.hessian.row(At(a));
      gradient[a] = scaled.gradient[At(a)];
    }
    for (Eigen::Index a = 0; a < size; ++a) hessian.col(a) = rows.col(At(a));
    const Eigen::LDLT<Matrix> factor(hessian);
    solution_ = -factor.solve(gradient);
    inverse_diagonal_ = factor.solve(Matrix::Identity(size, size)).diagonal();
    explained_ = factor.solve(rows);
    slopes_ += rows.transpose() * solution_;
    curvatures_ -= rows.cwiseProduct(explained_).colwise().sum().transpose();
    twice_cost_ = gradient.dot(solution_);
  }

  const std::vector<int>& support() const { return support_; }
  const Vector& solution() const { return solution_; }
  // 2 f at the minimum, less the constant.
  double twice_cost() const { return twice_cost_; }

  // Returns the increase of 2 f without the a-th entry.
  double Loss(Eigen::Index a) const {
    return solution_[a] * solution_[a] / inverse_diagonal_[a];
  }

  // Returns the decrease of 2 f with entry j, after the a-th has gone (-1:
  // none), and its value. 0 if it depends on those taken.
  double Gain(int j, Eigen::Index a, double* value) const {
    double slope = slopes_[j];
    double curvature = curvatures_[j];
    if (a >= 0) {
      const double share = explained_(a, j) / inverse_diagonal_[a];
      slope -= share * solution_[a];
      curvature += share * explained_(a, j);
    }
    *value = 0.0;
    if (!(curvature > kDependent)) return 0.0;
    *value = -slope / curvature;
    return slope * slope / curvature;
  }

 private:
  int At(Eigen::Index a) const { return support_[static_cast<size_t>(a)]; }

  std::vector<int> support_;
  Vector solution_;
  Vector inverse_diagonal_;
  Matrix explained_;  // support x all: regression of all columns on the support
  Vector slopes_;     // of f at the minimum
  Vector curvatures_;  // beside the support
  double twice_cost_ = 0.0;
};

// Returns the scale of each unknown for which the Hessian has a unit diagonal;
// 0 where the cost does not depend on it.
Vector Scales(const QuadraticCost& cost) {
  Vector scales = Vector::Zero(cost.gradient.size());
  for (Eigen::Index j = 0; j < scales.size(); ++j) {
    const double curvature = cost.hessian(j, j);
    if (curvature > 0.0) scales[j] = 1.0 / std::sqrt(curvature);
  }
  return scales;
}

QuadraticCost Scaled(const QuadraticCost& cost, const Vector& scales) {
  QuadraticCost scaled;
  scaled.gradient = cost.gradient.cwiseProduct(scales);
  scaled.hessian = scales.asDiagonal() * cost.hessian * scales.asDiagonal();
  return scaled;
}

// Descent on 2 f + prices of the entries over supports.
class Descent {
 public:
  Descent(const QuadraticCost& cost, const StepwiseOptions& options)
      : options_(options),
        scales_(Scales(cost)),
        cost_(Scaled(cost, scales_)),
        rounding_(kRounding * options.prices.lpNorm<Eigen::Infinity>()) {
    for (int j = 0; j < Count(); ++j) {
      if (!Optional(j)) required_.push_back(j);
    }
  }

  std::vector<int> Run(const std::vector<int>& start) const {
    Face best = Descend(start, -1, -1);
    // Entries of the start may hide missing ones.
    Keep(Descend({}, -1, -1), &best);
    while (ImproveByForce(&best)) {
    }
    return best.support();
  }

 private:
  int Count() const { return static_cast<int>(cost_.gradient.size()); }
  bool Optional(int j) const {
    return options_.optional[static_cast<size_t>(j)];
  }
  double Criterion(const Face& face) const {
    double criterion = face.twice_cost();
    for (int j : face.support()) criterion += options_.prices[j];
    return criterion;
  }
  // True if all entries still have an allowed value: later entries may have
  // changed it.
  bool IsAllowed(const Face& face) const {
    for (size_t a = 0; a < face.support().size(); ++a) {
      const int j = face.support()[a];
      const double value = face.solution()[static_cast<Eigen::Index>(a)];
      if (Optional(j) && !Allowed(j, value)) return false;
    }
    return true;
  }
  bool Keep(Face face, Face* best) const {
    const bool lower = Criterion(face) < Criterion(*best) - rounding_;
    if (!IsAllowed(face) || (IsAllowed(*best) && !lower)) return false;
    *best = std::move(face);
    return true;
  }

  // Removes one entry, else adds one, else exchanges one, as long as that
  // lowers the criterion. `banned` stays out, `locked` in; -1: none.
  Face Descend(const std::vector<int>& start, int banned, int locked) const {
    std::vector<bool> taken(static_cast<size_t>(Count()), false);
    for (int j : start) taken[static_cast<size_t>(j)] = true;
    for (int j : required_) taken[static_cast<size_t>(j)] = true;
    if (locked >= 0) taken[static_cast<size_t>(locked)] = true;
    if (banned >= 0 && Optional(banned)) {
      taken[static_cast<size_t>(banned)] = false;
    }
    Face face(cost_, Entries(taken));
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
      face = Face(cost_, Entries(taken));
    }
    return face;
  }

  // Holds one entry out, or in, against the criterion while the others are
  // chosen around it, and then releases it. If two entries do the work of one,
  // or one that of two, the first change between them is a loss.
  bool ImproveByForce(Face* best) const {
    const Face origin = *best;
    std::vector<bool> taken(static_cast<size_t>(Count()), false);
    for (int j : origin.support()) taken[static_cast<size_t>(j)] = true;
    bool improved = false;
    const auto attempt = [&](int banned, int locked) {
      const Face forced = Descend(origin.support(), banned, locked);
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

  Change Leaving(const Face& face, int locked) const {
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

  Change Coming(const Face& face, const std::vector<bool>& taken,
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

  Change Exchange(const Face& face, const std::vector<bool>& taken, int banned,
                  int locked) const {
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

  // True if an entry may have this value, in units of the scaled cost.
  bool Allowed(int j, double value) const {
    return scales_[j] * std::abs(value) >= options_.smallest[j] &&
           options_.signs[static_cast<size_t>(j)] * value >= 0.0;
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

}  // namespace

std::vector<int> SelectStepwise(const QuadraticCost& cost,
                                const StepwiseOptions& options,
                                const std::vector<int>& start) {
  const size_t count = static_cast<size_t>(cost.gradient.size());
  CHECK_EQ(options.prices.size(), static_cast<Eigen::Index>(count));
  CHECK_EQ(options.optional.size(), count);
  CHECK_EQ(options.signs.size(), count);
  CHECK_EQ(options.smallest.size(), static_cast<Eigen::Index>(count));
  return Descent(cost, options).Run(start);
}

Vector MinimizeOn(const QuadraticCost& cost, const std::vector<int>& support) {
  const Vector scales = Scales(cost);
  const Face face(Scaled(cost, scales), support);
  Vector theta = Vector::Zero(cost.gradient.size());
  for (size_t a = 0; a < support.size(); ++a) {
    const int j = support[a];
    theta[j] = scales[j] * face.solution()[static_cast<Eigen::Index>(a)];
  }
  return theta;
}

}  // namespace pinode
