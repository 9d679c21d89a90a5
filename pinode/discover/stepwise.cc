#include "pinode/discover/stepwise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// What a column may have left, of its square, beside those taken.
constexpr double kDependent = 1e-9;

// The entries of a support, their Hessian's factor and their minimum, scaled to
// a unit diagonal.
class Face {
 public:
  Face(const QuadraticCost& cost, const Vector& scales,
       const std::vector<int>& support)
      : cost_(cost), scales_(scales), support_(support) {
    const Eigen::Index size = static_cast<Eigen::Index>(support.size());
    Matrix hessian(size, size);
    Vector gradient(size);
    for (Eigen::Index a = 0; a < size; ++a) {
      gradient[a] = cost.gradient[At(a)] * scales[At(a)];
      for (Eigen::Index b = 0; b < size; ++b) hessian(a, b) = Scaled(a, At(b));
    }
    factor_.compute(hessian);
    solution_ = size > 0 ? Vector(-factor_.solve(gradient)) : Vector(0);
  }

  Vector Solution() const {
    Vector theta = Vector::Zero(cost_.gradient.size());
    for (Eigen::Index a = 0; a < solution_.size(); ++a) {
      theta[At(a)] = scales_[At(a)] * solution_[a];
    }
    return theta;
  }

  // Gain in 2 f of one more entry, and its value; 0 where it depends on those
  // taken.
  double Gain(int entry, double* value) const {
    const Eigen::Index size = solution_.size();
    Vector coupling(size);
    for (Eigen::Index a = 0; a < size; ++a) coupling[a] = Scaled(a, entry);
    double curvature = scales_[entry] > 0.0 ? 1.0 : 0.0;
    double slope = scales_[entry] * cost_.gradient[entry];
    if (size > 0) {
      curvature -= coupling.dot(factor_.solve(coupling));
      slope += coupling.dot(solution_);
    }
    *value = 0.0;
    if (!(curvature > kDependent)) return 0.0;
    *value = -scales_[entry] * slope / curvature;
    return slope * slope / curvature;
  }

  // Loss in 2 f of each entry of the support.
  Vector Losses() const {
    const Eigen::Index size = solution_.size();
    if (size == 0) return Vector(0);
    const Matrix inverse = factor_.solve(Matrix::Identity(size, size));
    return solution_.array().square() / inverse.diagonal().array();
  }

 private:
  int At(Eigen::Index a) const { return support_[static_cast<size_t>(a)]; }
  double Scaled(Eigen::Index a, int entry) const {
    return scales_[At(a)] * cost_.hessian(At(a), entry) * scales_[entry];
  }

  const QuadraticCost& cost_;
  const Vector& scales_;
  const std::vector<int>& support_;
  Eigen::LDLT<Matrix> factor_;
  Vector solution_;
};

Vector Scales(const QuadraticCost& cost) {
  Vector scales = Vector::Zero(cost.gradient.size());
  for (Eigen::Index j = 0; j < scales.size(); ++j) {
    const double curvature = cost.hessian(j, j);
    if (curvature > 0.0) scales[j] = 1.0 / std::sqrt(curvature);
  }
  return scales;
}

}  // namespace

std::vector<int> SelectStepwise(const QuadraticCost& cost,
                                const StepwiseOptions& options,
                                const std::vector<int>& start) {
  const int count = static_cast<int>(cost.gradient.size());
  CHECK_EQ(options.optional.size(), static_cast<size_t>(count));
  CHECK_EQ(options.signs.size(), static_cast<size_t>(count));
  CHECK_EQ(options.smallest.size(), count);
  const Vector scales = Scales(cost);
  std::vector<bool> taken(static_cast<size_t>(count), false);
  for (int j : start) taken[static_cast<size_t>(j)] = true;
  for (int j = 0; j < count; ++j) {
    if (!options.optional[static_cast<size_t>(j)]) {
      taken[static_cast<size_t>(j)] = true;
    }
  }
  const auto support = [&] {
    std::vector<int> entries;
    for (int j = 0; j < count; ++j) {
      if (taken[static_cast<size_t>(j)]) entries.push_back(j);
    }
    return entries;
  };
  const auto add_one = [&] {
    const std::vector<int> entries = support();
    const Face face(cost, scales, entries);
    int best = -1;
    double most = options.price;
    for (int j = 0; j < count; ++j) {
      if (taken[static_cast<size_t>(j)]) continue;
      double value;
      const double gain = face.Gain(j, &value);
      const int sign = options.signs[static_cast<size_t>(j)];
      if (gain > most && std::abs(value) >= options.smallest[j] &&
          sign * value >= 0.0) {
        most = gain;
        best = j;
      }
    }
    if (best >= 0) taken[static_cast<size_t>(best)] = true;
    return best >= 0;
  };
  const auto drop_one = [&] {
    const std::vector<int> entries = support();
    const Vector losses = Face(cost, scales, entries).Losses();
    int weakest = -1;
    // Not the price itself: what has just come in for more than the price
    // would go and come for ever within rounding.
    double least = options.price * (1.0 - 1e-9);
    for (size_t a = 0; a < entries.size(); ++a) {
      const double loss = losses[static_cast<Eigen::Index>(a)];
      if (options.optional[static_cast<size_t>(entries[a])] && loss < least) {
        least = loss;
        weakest = entries[a];
      }
    }
    if (weakest >= 0) taken[static_cast<size_t>(weakest)] = false;
    return weakest >= 0;
  };
  // Each change lowers the criterion; rounding may still let two supports of
  // equal merit alternate.
  const int most_rounds = 2 * count + 10;
  for (int round = 0; round < most_rounds; ++round) {
    bool changed = false;
    while (drop_one()) changed = true;
    while (add_one()) changed = true;
    if (!changed) break;
  }
  return support();
}

Vector MinimizeOn(const QuadraticCost& cost, const std::vector<int>& support) {
  const Vector scales = Scales(cost);
  return Face(cost, scales, support).Solution();
}

}  // namespace pinode
