#include "pinode/estimate/solver/bounded_step.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>
#include <vector>

#include "pinode/base/power_of_two.h"

namespace pinode {
namespace {

// Bound at which an unknown is held: its lower one, none, its upper one.
enum class Held { kLower, kNot, kUpper };

// Active set, in units in which the Hessian's diagonal is about one.
class ActiveSet {
 public:
  ActiveSet(Matrix hessian, Vector gradient, Vector lower, Vector upper)
      : hessian_(std::move(hessian)),
        gradient_(std::move(gradient)),
        lower_(std::move(lower)),
        upper_(std::move(upper)),
        step_(Vector::Zero(gradient_.size())),
        held_(static_cast<size_t>(gradient_.size()), Held::kNot) {
    for (Eigen::Index j = 0; j < gradient_.size(); ++j) {
      if (lower_[j] >= 0.0 && gradient_[j] > 0.0) At(j) = Held::kLower;
      if (upper_[j] <= 0.0 && gradient_[j] < 0.0) At(j) = Held::kUpper;
    }
  }

  bool Solve() {
    // Every turn changes the place of one unknown. More turns than this would
    // be a cycle caused by rounding.
    const Eigen::Index most = 10 * gradient_.size() + 10;
    for (Eigen::Index turn = 0; turn < most; ++turn) {
      Vector target;
      if (!FreeMinimum(&target)) return false;
      if (MoveTowards(target)) continue;  // up to a bound, which now holds
      if (!Release()) break;
    }
    return step_.allFinite();
  }

  const Vector& step() const { return step_; }

 private:
  Held& At(Eigen::Index j) { return held_[static_cast<size_t>(j)]; }

  // Finds the minimum over the free unknowns, given the others.
  bool FreeMinimum(Vector* target) {
    std::vector<Eigen::Index> free;
    Vector held = step_;
    for (Eigen::Index j = 0; j < step_.size(); ++j) {
      if (At(j) != Held::kNot) continue;
      free.push_back(j);
      held[j] = 0.0;
    }
    *target = step_;
    if (free.empty()) return true;
    const Vector right = -(gradient_ + hessian_ * held)(free);
    const Matrix block = hessian_(free, free);
    for (double shift = 0.0; shift < 1e-3;
         shift = shift == 0.0 ? 1e-15 : 10.0 * shift) {
      Matrix shifted = block;
      shifted.diagonal().array() += shift * static_cast<double>(free.size());
      const Eigen::LLT<Matrix> factor(shifted);
      if (factor.info() != Eigen::Success) continue;
      const Vector solution = factor.solve(right);
      (*target)(free) = solution;
      if (target->allFinite()) return true;
    }
    return false;
  }

  // Moves towards the target; true if a bound came first.
  bool MoveTowards(const Vector& target) {
    double share = 1.0;
    Eigen::Index first = -1;
    for (Eigen::Index j = 0; j < step_.size(); ++j) {
      const double change = target[j] - step_[j];
      if (At(j) != Held::kNot || change == 0.0) continue;
      const double room = (change > 0.0 ? upper_[j] : lower_[j]) - step_[j];
      if (room / change < share) {
        share = room / change;
        first = j;
      }
    }
    const double upwards = first < 0 ? 0.0 : target[first] - step_[first];
    step_ += share * (target - step_);
    if (first < 0) return false;
    At(first) = upwards > 0.0 ? Held::kUpper : Held::kLower;
    step_[first] = upwards > 0.0 ? upper_[first] : lower_[first];
    return true;
  }

  // Releases the unknown that is held most against the slope; false if there is
  // none.
  bool Release() {
    const Vector slope = gradient_ + hessian_ * step_;
    const double rounding =
        1e-14 * (gradient_.cwiseAbs().maxCoeff() + kTiniest);
    Eigen::Index most = -1;
    double steepest = rounding;
    for (Eigen::Index j = 0; j < step_.size(); ++j) {
      const double outwards = At(j) == Held::kLower   ? -slope[j]
                              : At(j) == Held::kUpper ? slope[j]
                                                      : 0.0;
      if (outwards > steepest) {
        steepest = outwards;
        most = j;
      }
    }
    if (most < 0) return false;
    At(most) = Held::kNot;
    return true;
  }

  static constexpr double kTiniest = 1e-300;

  const Matrix hessian_;
  const Vector gradient_, lower_, upper_;
  Vector step_;
  std::vector<Held> held_;
};

}  // namespace

bool BoundedStep(const Matrix& hessian, const Vector& gradient,
                 const Vector& lower, const Vector& upper, Vector* step) {
  const Eigen::Index n = gradient.size();
  *step = Vector::Zero(n);
  if (!hessian.allFinite() || !gradient.allFinite()) return false;
  // Scales by powers of two, which are exact: bounds keep their values.
  Vector scale(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    scale[j] = hessian(j, j) > 0.0
                   ? 1.0 / PowerOfTwoBelow(std::sqrt(hessian(j, j)))
                   : 1.0;
  }
  Matrix scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
  // Unknowns without effect stay in place.
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!(hessian(j, j) > 0.0)) scaled(j, j) = 1.0;
  }
  ActiveSet set(scaled, scale.cwiseProduct(gradient),
                lower.cwiseQuotient(scale), upper.cwiseQuotient(scale));
  if (!set.Solve()) return false;
  *step = scale.cwiseProduct(set.step()).cwiseMax(lower).cwiseMin(upper);
  return true;
}

}  // namespace pinode
