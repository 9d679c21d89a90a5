#include "pinode/estimate/solver/optimality.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/estimate/solver/bounded_step.h"

namespace pinode {

bool IsHeldAtBound(const Parameter& parameter, double value, double slope) {
  return (value <= parameter.lower && slope > 0.0) ||
         (value >= parameter.upper && slope < 0.0);
}

bool Optimality::IsStalled(double cost, double first_cost) const {
  // Converged fits end below 1e-9, those that stall above 1e-1.
  constexpr double kMostPromise = 1e-4;
  constexpr double kRounding = 1e-10;
  return promise > kMostPromise && promise * cost > kRounding * first_cost;
}

bool BestStep(const ParameterLayout& layout, const Vector& free,
              const CondensedSystem& system, int held, Vector* step,
              double* promise) {
  const int n = layout.num_free();
  Vector lower(n), upper(n);
  for (int j = 0; j < n; ++j) {
    const Parameter& parameter = layout.free_parameter(j);
    lower[j] = j == held ? 0.0 : std::min(0.0, parameter.lower - free[j]);
    upper[j] = j == held ? 0.0 : std::max(0.0, parameter.upper - free[j]);
  }
  if (!BoundedStep(system.hessian, system.gradient, lower, upper, step)) {
    return false;
  }
  *promise = std::max(0.0, -step->dot(system.gradient) -
                               0.5 * step->dot(system.hessian * *step));
  return true;
}

Optimality MeasureOptimality(const ParameterLayout& layout, const Vector& free,
                             const CondensedSystem& system) {
  Optimality optimality;
  const int n = layout.num_free();
  if (!(system.cost > 0.0) || n == 0) return optimality;
  for (int j = 0; j < n; ++j) {
    const double slope = system.gradient[j];
    if (!(system.hessian(j, j) > 0.0) ||
        IsHeldAtBound(layout.free_parameter(j), free[j], slope)) {
      continue;
    }
    optimality.cosine = std::max(
        optimality.cosine,
        std::abs(slope) / std::sqrt(2.0 * system.cost * system.hessian(j, j)));
  }
  Vector step;
  double saved = 0.0;
  optimality.promise = BestStep(layout, free, system, -1, &step, &saved)
                           ? saved / system.cost
                           : kInfinity;
  return optimality;
}

}  // namespace pinode
