#include "pinode/estimate/certainty/profile_combinations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pinode {
namespace {

// Straight line through points, and their distance from it as a share of their
// own spread.
struct Line {
  double slope = 0.0;
  double misfit = 1.0;
};

Line FitLine(const RowVector& x, const RowVector& y) {
  const RowVector dx = x.array() - x.mean();
  const RowVector dy = y.array() - y.mean();
  Line line;
  if (!(dx.squaredNorm() > 0.0) || !(dy.squaredNorm() > 0.0)) return line;
  line.slope = dx.dot(dy) / dx.squaredNorm();
  line.misfit = (dy - line.slope * dx).norm() / dy.norm();
  return line;
}

bool HasOneSign(const RowVector& x) {
  return (x.array() > 0.0).all() || (x.array() < 0.0).all();
}

double SpreadOf(const RowVector& x) { return x.maxCoeff() - x.minCoeff(); }

std::string PowerText(const std::string& name, double power) {
  if (power == 1.0) return name;
  char text[32];
  std::snprintf(text, sizeof(text), "^%g", power);
  return name + text;
}

// Returns "a * b^2" if log b against log a has a slope that is a simple power;
// empty otherwise.
std::string ProductText(const std::string& along, const std::string& other,
                        double slope, bool only_first_power) {
  constexpr double kTolerance = 0.02;
  for (const double power : {1.0, 2.0, 0.5, 3.0}) {
    if (only_first_power && power != 1.0) break;
    if (std::abs(std::abs(slope) - power) > kTolerance * power) continue;
    // b ~ a^slope: b / a^slope stays.
    const std::string of_along = power < 1.0 ? along : PowerText(along, power);
    const std::string of_other =
        power < 1.0 ? PowerText(other, 1.0 / power) : other;
    return slope < 0.0 ? of_along + " * " + of_other
                       : of_other + " / " + of_along;
  }
  return "";
}

}  // namespace

std::vector<std::string> DescribeCombinations(
    const std::vector<std::string>& names, const Matrix& values, int along) {
  constexpr double kMoves = 0.01;  // of its own size, or of the path's
  constexpr double kStraight = 0.02;
  std::vector<std::string> result;
  if (values.cols() < 3) return result;
  const RowVector a = values.row(along);
  const std::string& name = names[static_cast<size_t>(along)];
  const double path = SpreadOf(a) / std::max(a.cwiseAbs().maxCoeff(), 1e-300);
  for (Eigen::Index j = 0; j < values.rows(); ++j) {
    const RowVector b = values.row(j);
    const double size = b.cwiseAbs().maxCoeff();
    if (j == along || !(SpreadOf(b) > kMoves * path * size)) continue;
    const std::string& other = names[static_cast<size_t>(j)];
    std::string text;
    const Line sum = FitLine(a, b);
    // If both change their sign together, a product or quotient may stay
    // constant, but no other power.
    if (HasOneSign(a.cwiseProduct(b))) {
      const Line power = FitLine(a.cwiseAbs().array().log().matrix(),
                                 b.cwiseAbs().array().log().matrix());
      if (power.misfit < kStraight && power.misfit <= sum.misfit) {
        text = ProductText(name, other, power.slope, !HasOneSign(a));
      }
    }
    if (text.empty() && sum.misfit < kStraight) {
      char factor[32];
      std::snprintf(factor, sizeof(factor), "%.3g ", std::abs(sum.slope));
      text = other + (sum.slope < 0.0 ? " + " : " - ") +
             (std::abs(std::abs(sum.slope) - 1.0) < 0.005 ? "" : factor) + name;
    }
    if (!text.empty()) result.push_back(text);
  }
  return result;
}

}  // namespace pinode
