#include "pinode/estimate/solve.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "pinode/base/logging.h"
#include "pinode/estimate/bounded_cost.h"
#include "pinode/estimate/condensed_cost.h"
#include "pinode/estimate/force_bands.h"
#include "pinode/estimate/optimality.h"

namespace pinode {
namespace {

// Up to so many unknowns Ceres' QR, the more accurate way, takes no time to
// speak of.
constexpr int kMostForQr = 100;

// The hidden units of a network of time hardly move: its first step is that of
// a linear fit.
double FirstRadius(const FitContext& context) {
  const SolveTuning& tuning = context.tuning().solve;
  const auto& networks = context.problem.dynamics->networks();
  return !context.HasNetworks() ||
                 std::all_of(networks.begin(), networks.end(), IsForceOfTime)
             ? tuning.first_radius
             : tuning.first_network_radius;
}

void SetBounds(const BoundedCost& cost, double* scaled,
               ceres::Problem* problem) {
  for (int j = 0; j < cost.lower().size(); ++j) {
    if (std::isfinite(cost.lower()[j])) {
      problem->SetParameterLowerBound(scaled, j, cost.lower()[j]);
    }
    if (std::isfinite(cost.upper()[j])) {
      problem->SetParameterUpperBound(scaled, j, cost.upper()[j]);
    }
  }
}

ceres::Solver::Options SolverOptions(const FitContext& context,
                                     double function_tolerance, double radius) {
  const SolveTuning& tuning = context.tuning().solve;
  ceres::Solver::Options options;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = function_tolerance;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 0.0;
  options.initial_trust_region_radius =
      std::clamp(radius, tuning.least_radius, tuning.most_radius);
  options.max_num_consecutive_invalid_steps = 50;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;
  if (context.HasNetworks()) {
    options.use_nonmonotonic_steps = true;
    options.max_consecutive_nonmonotonic_steps = tuning.uphill_steps;
  }
  return options;
}

}  // namespace

// Ceres' iterations as one's own.
class Solver::Callback final : public ceres::IterationCallback {
 public:
  Callback(Solver* solver, const BoundedCost& bounded, const Vector& scaled,
           double tolerance)
      : solver_(solver),
        bounded_(bounded),
        scaled_(scaled),
        tolerance_(tolerance),
        first_iteration_(solver->context_.summary.num_iterations) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    const Vector free = bounded_.Unscaled(scaled_);
    if (!solver_->Note(
            first_iteration_,
            {iteration.iteration, iteration.cost, iteration.gradient_norm,
             iteration.step_norm, iteration.trust_region_radius,
             iteration.step_is_successful},
            free)) {
      return ceres::SOLVER_ABORT;
    }
    return iteration.step_is_successful &&
                   solver_->IsSettled(free, bounded_.system(), tolerance_)
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  Solver* solver_;
  const BoundedCost& bounded_;
  const Vector& scaled_;
  double tolerance_;
  int first_iteration_;
};

Solver::Solver(const FitContext& context, Progress* progress)
    : context_(context), progress_(progress) {
  ResetRadius();
}

bool Solver::Note(int first_iteration,
                  const LevenbergMarquardt::Iteration& iteration,
                  const Vector& free) {
  IdentificationSummary& summary = context_.summary;
  IterationRecord record;
  record.iteration = first_iteration + iteration.number;
  record.cost = iteration.cost;
  record.gradient_norm = iteration.gradient_norm;
  record.step_norm = iteration.step_norm;
  record.trust_region_radius = iteration.radius;
  record.largest_gap = context_.objective.shooting().LargestGap();
  record.accepted = iteration.accepted;
  if (iteration.number > 0) {
    summary.num_iterations = record.iteration;
    if (!iteration.accepted) ++summary.rejected_steps;
  }
  radius_ = iteration.radius;
  return progress_->Note(record, free);
}

void Solver::ResetRadius() { radius_ = FirstRadius(context_); }

bool Solver::IsSettled(const Vector& free, const CondensedSystem& system,
                       double tolerance) const {
  return !context_.HasNetworks() &&
         MeasureOptimality(context_.layout, free, system).promise < tolerance;
}

void Solver::Settle(const CondensedSystem& system, double gradient_norm,
                    FitState* state) {
  IterationRecord record;
  record.iteration = context_.summary.num_iterations;
  record.cost = state->cost = system.cost;
  record.gradient_norm = gradient_norm;
  record.trust_region_radius = radius_;
  record.largest_gap = context_.objective.shooting().LargestGap();
  record.accepted = true;
  progress_->Note(record, state->free);
  state->optimality = MeasureOptimality(context_.layout, state->free, system);
}

bool Solver::Solve(int max_iterations, double function_tolerance,
                   FitState* state, bool* converged) {
  *converged = false;
  max_iterations =
      std::min(max_iterations, context_.options.max_num_iterations -
                                   context_.summary.num_iterations);
  if (max_iterations <= 0) return true;
  const bool solved =
      context_.layout.num_free() <= kMostForQr
          ? SolveByCeres(max_iterations, function_tolerance, state, converged)
          : SolveMany(max_iterations, function_tolerance, state, converged);
  if (!solved) context_.summary.message = context_.objective.Failure();
  return solved;
}

bool Solver::Conclude(bool converged, FitState* state) {
  CondensedSystem system;
  if (!context_.objective.Linearize(state->free, &system)) return false;
  state->cost = system.cost;
  if (converged) {
    state->optimality = MeasureOptimality(context_.layout, state->free, system);
    VLOG(1) << "converged, cost " << state->cost << ", cosine "
            << state->optimality.cosine << ", promise "
            << state->optimality.promise;
  }
  return true;
}

bool Solver::SolveMany(int max_iterations, double function_tolerance,
                       FitState* state, bool* converged) {
  const SolveTuning& tuning = context_.tuning().solve;
  IdentificationSummary& summary = context_.summary;
  CondensedSystem system;
  if (!context_.HasNetworks() &&
      !context_.objective.Linearize(state->free, &system)) {
    return false;
  }
  if (IsSettled(state->free, system, function_tolerance)) {
    *converged = true;
    Settle(system, system.gradient.norm(), state);
    return true;
  }
  LevenbergMarquardt::Options options;
  options.max_iterations = max_iterations;
  options.function_tolerance = function_tolerance;
  options.radius = std::clamp(radius_, tuning.least_radius, tuning.most_radius);
  options.uphill_steps = context_.HasNetworks() ? tuning.uphill_steps : 0;
  LevenbergMarquardt minimizer(context_.layout, options, &context_.objective);
  const int first = summary.num_iterations;
  bool settled = false;
  const LevenbergMarquardt::Outcome outcome = minimizer.Run(
      [&](const LevenbergMarquardt::Iteration& iteration,
          const CondensedSystem& at, const Vector& free) {
        if (!Note(first, iteration, free)) return false;
        settled = iteration.accepted && iteration.number > 0 &&
                  IsSettled(free, at, function_tolerance);
        return !settled;
      },
      &state->free);
  summary.jacobian_seconds += outcome.cost_seconds;
  summary.linear_solver_seconds += outcome.solver_seconds;
  summary.failed_evaluations += outcome.failed_evaluations;
  if (outcome.end == LevenbergMarquardt::End::kNoCost) return false;
  *converged = settled || outcome.end == LevenbergMarquardt::End::kConverged;
  return Conclude(*converged, state);
}

bool Solver::SolveByCeres(int max_iterations, double function_tolerance,
                          FitState* state, bool* converged) {
  IdentificationSummary& summary = context_.summary;
  Objective& objective = context_.objective;
  ceres::Solver::Options options =
      SolverOptions(context_, function_tolerance, radius_);
  options.max_num_iterations = max_iterations;

  const int n = context_.layout.num_free();
  const auto begin = std::chrono::steady_clock::now();
  BoundedCost bounded(context_.layout, state->free, &objective);
  summary.jacobian_seconds += SecondsSince(begin);
  if (!bounded.IsValid()) return false;
  Vector scaled = bounded.Scaled(state->free);
  if (IsSettled(state->free, bounded.system(), function_tolerance)) {
    *converged = true;
    CondensedSystem steps;
    if (!bounded.Linearize(scaled, &steps)) return false;
    Settle(bounded.system(), steps.gradient.norm(), state);
    return true;
  }
  CondensedCost cost(&bounded, n);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(&cost, nullptr, scaled.data());
  SetBounds(bounded, scaled.data(), &problem);

  Callback callback(this, bounded, scaled, function_tolerance);
  options.callbacks.push_back(&callback);

  ceres::Solver::Summary ceres_summary;
  ceres::Solve(options, &problem, &ceres_summary);
  summary.jacobian_seconds += cost.jacobian_seconds();
  summary.linear_solver_seconds += ceres_summary.linear_solver_time_in_seconds;
  summary.failed_evaluations += cost.failed_evaluations();
  VLOG(2) << ceres_summary.FullReport();
  if (ceres_summary.termination_type == ceres::FAILURE &&
      ceres_summary.iterations.size() <= 1) {
    return false;
  }
  state->free = bounded.Unscaled(scaled);
  *converged = ceres_summary.termination_type == ceres::CONVERGENCE ||
               ceres_summary.termination_type == ceres::USER_SUCCESS;
  return Conclude(*converged, state);
}

bool Solver::Polish(FitState* state) {
  constexpr int kMostSteps = 2;
  // Of the cost: what is less than this cannot be seen.
  constexpr double kLeastPromise = 1e-12;
  // Keeps what nothing determines where it is.
  constexpr double kDamping = 1e-6;
  Objective& objective = context_.objective;
  const auto fail = [&]() {
    context_.summary.message = objective.Failure();
    return false;
  };
  CondensedSystem system;
  if (!objective.Linearize(state->free, &system)) return fail();
  for (int i = 0; i < kMostSteps; ++i) {
    CondensedSystem damped = system;
    damped.hessian.diagonal() *= 1.0 + kDamping;
    Vector step;
    double promise = 0.0;
    if (!BestStep(context_.layout, state->free, damped, -1, &step, &promise) ||
        !(promise > kLeastPromise * system.cost)) {
      break;
    }
    const Vector next = state->free + step;
    double cost = 0.0;
    if (!objective.Evaluate(next, &cost) || !(cost < system.cost) ||
        !objective.Linearize(next, &system)) {
      if (!objective.Linearize(state->free, &system)) return fail();
      break;
    }
    state->free = next;
  }
  state->cost = system.cost;
  state->optimality = MeasureOptimality(context_.layout, state->free, system);
  return true;
}

}  // namespace pinode
