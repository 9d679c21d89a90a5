#include "pinode/discover/robust_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/discover/least_squares_system.h"

namespace pinode {

Vector FitRobustly(const RegressionProblem& problem, const CoefficientMap& map,
                   const SelectionEntry& entry) {
  constexpr double kHuber = 1.345;
  constexpr double kMedianToSigma = 1.4826;
  constexpr int kMaxNumIterations = 100;
  constexpr double kTolerance = 1e-10;
  CHECK_EQ(problem.outputs.size(), 1u);
  Vector coefficients = entry.coefficients;
  if (entry.support.empty()) return coefficients;
  const std::vector<int> support = map.ReduceSupport(entry.support);
  const RegressionOutput& original = problem.outputs[0];
  RegressionProblem weighted = problem;
  for (int iteration = 0; iteration < kMaxNumIterations; ++iteration) {
    const Vector residual = original.y - original.theta * coefficients;
    Vector sorted = residual.cwiseAbs();
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2,
                     sorted.end());
    const double limit = kHuber * kMedianToSigma * sorted[sorted.size() / 2];
    if (!(limit > 0.0)) break;
    for (Eigen::Index i = 0; i < residual.size(); ++i) {
      const double weight =
          std::sqrt(std::min(1.0, limit / std::abs(residual[i])));
      weighted.outputs[0].y[i] = weight * original.y[i];
      weighted.outputs[0].theta.row(i) = weight * original.theta.row(i);
    }
    const Vector next =
        map.Expand(FitSupport(Condense(weighted, map), map, support));
    const double moved = (next - coefficients).norm();
    coefficients = next;
    if (moved <= kTolerance * coefficients.norm()) break;
  }
  return coefficients;
}

}  // namespace pinode
