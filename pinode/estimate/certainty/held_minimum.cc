#include "pinode/estimate/certainty/held_minimum.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "pinode/estimate/objective/bent_cost.h"
#include "pinode/estimate/solver/bounded_cost.h"
#include "pinode/estimate/solver/condensed_cost.h"
#include "pinode/estimate/solver/optimality.h"

namespace pinode {
namespace {

// Initial radii. Straight steps begin with a Gauss-Newton step. With bent steps
// the first search is cautious, and the next ones begin with the last radius.
constexpr double kStraightRadius = 1e8;
constexpr double kBentRadius = 1e3;

// Counts the evaluations of a cost by a solve.
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

// Keeps the radius for steps that bend.
class WalkCallback final : public ceres::IterationCallback {
 public:
  WalkCallback(const std::function<bool()>& stop, double* radius)
      : stop_(stop), radius_(radius) {}
  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    *radius_ = iteration.trust_region_radius;
    return stop_ && stop_() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<bool()>& stop_;
  double* radius_;
};

// Runs Ceres. `function_tolerance`: a share of the cost.
void Solve(const BoundedCost& bounded, CostPart* part,
           const HeldOptions& held_options, double function_tolerance,
           double* radius, Vector* scaled, bool* converged) {
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  const int n = static_cast<int>(scaled->size());
  CondensedCost cost(part, n);
  problem.AddResidualBlock(&cost, nullptr, scaled->data());
  const int held = held_options.held;
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
  WalkCallback callback(held_options.stop, radius);
  ceres::Solver::Options options;
  options.linear_solver_type = DenseSolverFor(n);
  options.max_num_iterations = held_options.max_iterations;
  options.function_tolerance = function_tolerance;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 0.0;
  options.initial_trust_region_radius = *radius;
  options.logging_type = ceres::SILENT;
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  *converged = summary.termination_type == ceres::CONVERGENCE;
}

// Takes steps of the quadratic model from `minimum`, which has been linearised,
// while they achieve a fair part of their promise. Levenberg-Marquardt cuts its
// steps at bounds and then creeps along them.
void StepWithinBounds(const ParameterLayout& layout, const HeldOptions& options,
                      CostPart* cost, HeldMinimum* minimum) {
  constexpr double kLeastShare = 0.25;
  for (int i = 0; i < options.max_iterations; ++i) {
    if (options.stop && options.stop()) return;
    Vector step;
    double promise = 0.0;
    if (!BestStep(layout, minimum->free, minimum->system, options.held, &step,
                  &promise)) {
      return;
    }
    minimum->converged = promise < options.tolerance;
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

}  // namespace

HeldMinimizer::HeldMinimizer(const IdentificationProblem& problem,
                             const ParameterLayout& layout,
                             Objective* objective)
    : layout_(layout),
      objective_(objective),
      bends_(BendsSteps(problem, layout)),
      radius_(kBentRadius) {}

// Finishes the search with Ceres.
bool HeldMinimizer::FinishByCeres(const HeldOptions& options, CostPart* cost,
                                  HeldMinimum* minimum) {
  BoundedCost bounded(layout_, minimum->free, cost);
  if (!bounded.IsValid()) return false;
  Vector scaled = bounded.Scaled(minimum->free);
  double radius = bends_ ? radius_ : kStraightRadius;
  std::optional<BentCost> bent;
  if (bends_) {
    bent.emplace(&bounded, BendOf(objective_, &bounded), &radius, options.held);
  }
  const double held_value =
      options.held >= 0 ? minimum->free[options.held] : 0.0;
  Solve(bounded, bends_ ? static_cast<CostPart*>(&*bent) : &bounded, options,
        std::max(1e-14,
                 options.tolerance / std::max(minimum->system.cost, 1e-300)),
        &radius, &scaled, &minimum->converged);
  if (bends_) {
    scaled = bent->PointOf(scaled);
    radius_ = radius;
  }
  minimum->free = bounded.Unscaled(scaled);
  if (options.held >= 0) minimum->free[options.held] = held_value;
  return cost->Linearize(minimum->free, &minimum->system);
}

bool HeldMinimizer::Minimize(const Vector& start, const HeldOptions& options,
                             HeldMinimum* minimum) {
  bends_ = objective_->shooting().KeepRows(bends_);
  CountedCost counted(objective_);
  minimum->free = start;
  minimum->converged = false;
  if (!counted.Linearize(start, &minimum->system)) return false;
  StepWithinBounds(layout_, options, &counted, minimum);
  if (!minimum->converged && !(options.stop && options.stop()) &&
      !FinishByCeres(options, &counted, minimum)) {
    return false;
  }
  minimum->linearizations = counted.linearizations();
  return true;
}

}  // namespace pinode
