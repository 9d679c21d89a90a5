#include "pinode/estimate/held_minimum.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/estimate/bounded_cost.h"
#include "pinode/estimate/condensed_cost.h"
#include "pinode/estimate/optimality.h"

namespace pinode {
namespace {

// Counts what a solve asks of a cost.
class CountedCost final : public CostPart {
 public:
  explicit CountedCost(CostPart* part) : part_(part) {}

  bool Evaluate(const Vector& free, double* cost) override {
    return part_->Evaluate(free, cost);
  }
  bool Linearize(const Vector& free, CondensedSystem* system) override {
    ++linearizations_;
    return part_->Linearize(free, system);
  }
  std::string Failure() const override { return part_->Failure(); }

  int linearizations() const { return linearizations_; }

 private:
  CostPart* part_;
  int linearizations_ = 0;
};

class StopCallback final : public ceres::IterationCallback {
 public:
  explicit StopCallback(const std::function<bool()>& stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& /*iteration*/) override {
    return stop_ && stop_() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<bool()>& stop_;
};

void Solve(const BoundedCost& bounded, const CondensedCost& cost, int held,
           double tolerance, int max_iterations, ceres::IterationCallback* stop,
           Vector* scaled, bool* converged) {
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(const_cast<CondensedCost*>(&cost), nullptr,
                           scaled->data());
  const int n = static_cast<int>(scaled->size());
  if (held >= 0) {
    problem.SetManifold(scaled->data(), new ceres::SubsetManifold(n, {held}));
  }
  for (int j = 0; j < n; ++j) {
    if (j == held) continue;
    if (std::isfinite(bounded.lower()[j])) {
      problem.SetParameterLowerBound(scaled->data(), j, bounded.lower()[j]);
    }
    if (std::isfinite(bounded.upper()[j])) {
      problem.SetParameterUpperBound(scaled->data(), j, bounded.upper()[j]);
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = tolerance;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 0.0;
  options.initial_trust_region_radius = 1e8;
  options.logging_type = ceres::SILENT;
  options.callbacks.push_back(stop);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  *converged = summary.termination_type == ceres::CONVERGENCE;
}

// Steps of the quadratic model from `minimum`, which has been linearised, while
// they bring a fair part of what they promise. Levenberg-Marquardt cuts its
// steps at bounds and then creeps along them.
void StepWithinBounds(const ParameterLayout& layout, int held, double tolerance,
                      int max_iterations, const std::function<bool()>& stop,
                      CostPart* cost, HeldMinimum* minimum) {
  constexpr double kLeastShare = 0.25;
  for (int i = 0; i < max_iterations && !(stop && stop()); ++i) {
    Vector step;
    double promise = 0.0;
    if (!BestStep(layout, minimum->free, minimum->system, held, &step,
                  &promise)) {
      return;
    }
    minimum->converged = promise < tolerance;
    if (minimum->converged) return;
    const Vector next = minimum->free + step;
    CondensedSystem system;
    if (!cost->Evaluate(next, &system.cost) ||
        minimum->system.cost - system.cost < kLeastShare * promise ||
        !cost->Linearize(next, &system)) {
      return;
    }
    minimum->free = next;
    minimum->system = system;
  }
}

// What is left for Ceres.
bool FinishByCeres(const ParameterLayout& layout, int held, double tolerance,
                   int max_iterations, const std::function<bool()>& stop,
                   CostPart* cost, HeldMinimum* minimum) {
  BoundedCost bounded(layout, minimum->free, cost);
  if (!bounded.IsValid()) return false;
  Vector scaled = bounded.Scaled(minimum->free);
  const CondensedCost residuals(&bounded, layout.num_free());
  StopCallback callback(stop);
  const double held_value = held >= 0 ? minimum->free[held] : 0.0;
  // Ceres takes it as a share of the cost.
  Solve(bounded, residuals, held,
        std::max(1e-14, tolerance / std::max(minimum->system.cost, 1e-300)),
        max_iterations, &callback, &scaled, &minimum->converged);
  minimum->free = bounded.Unscaled(scaled);
  if (held >= 0) minimum->free[held] = held_value;
  return cost->Linearize(minimum->free, &minimum->system);
}

}  // namespace

bool MinimizeHolding(const ParameterLayout& layout, int held,
                     const Vector& start, double tolerance, int max_iterations,
                     const std::function<bool()>& stop, CostPart* cost,
                     HeldMinimum* minimum) {
  CountedCost counted(cost);
  minimum->free = start;
  minimum->converged = false;
  if (!counted.Linearize(start, &minimum->system)) return false;
  StepWithinBounds(layout, held, tolerance, max_iterations, stop, &counted,
                   minimum);
  if (!minimum->converged && !(stop && stop()) &&
      !FinishByCeres(layout, held, tolerance, max_iterations, stop, &counted,
                     minimum)) {
    return false;
  }
  minimum->linearizations = counted.linearizations();
  return true;
}

}  // namespace pinode
