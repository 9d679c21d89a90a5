#include "pinode/estimate/fit/solve.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/base/stopwatch.h"
#include "pinode/estimate/fit/valley.h"
#include "pinode/estimate/objective/bent_cost.h"
#include "pinode/estimate/solver/bounded_cost.h"
#include "pinode/estimate/solver/condensed_cost.h"
#include "pinode/estimate/solver/optimality.h"

namespace pinode {
namespace {

double FirstRadius(const FitContext& context) {
  const SolveTuning& tuning = context.tuning().solve;
  return HasNetworksOfState(context.problem, context.layout)
             ? tuning.first_network_radius
             : tuning.first_radius;
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

// Returns Ceres' options. `bends`: true if steps bend.
ceres::Solver::Options SolverOptions(const FitContext& context, bool bends,
                                     double function_tolerance, double radius) {
  const SolveTuning& tuning = context.tuning().solve;
  ceres::Solver::Options options;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = DenseSolverFor(context.layout.num_free());
  options.function_tolerance = function_tolerance;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 0.0;
  options.initial_trust_region_radius =
      std::clamp(radius, tuning.least_radius, tuning.most_radius);
  options.max_num_consecutive_invalid_steps = 50;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;
  if (context.HasNetworks() && !bends) {
    options.use_nonmonotonic_steps = true;
    options.max_consecutive_nonmonotonic_steps = tuning.uphill_steps;
  }
  return options;
}

}  // namespace

class Solver::Callback final : public ceres::IterationCallback {
 public:
  Callback(const Solver& solver, const BoundedCost& bounded,
           const BentCost* bent, const Vector& scaled, const Limits& limits,
           double* radius)
      : solver_(solver),
        context_(solver.context_),
        bounded_(bounded),
        bent_(bent),
        scaled_(scaled),
        limits_(limits),
        radius_(radius),
        valley_(limits.valley),
        first_iteration_(context_.summary.num_iterations) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    IterationRecord record;
    record.iteration = first_iteration_ + iteration.iteration;
    record.cost = iteration.cost;
    record.gradient_norm = iteration.gradient_norm;
    record.step_norm = iteration.step_norm;
    record.trust_region_radius = iteration.trust_region_radius;
    record.largest_gap = context_.objective.shooting().LargestGap();
    record.accepted = iteration.step_is_successful;
    if (iteration.iteration > 0) {
      solver_.log_->CountIteration(record.iteration,
                                   iteration.step_is_successful);
    }
    *radius_ = iteration.trust_region_radius;
    const Vector free =
        bounded_.Unscaled(bent_ == nullptr ? scaled_ : bent_->PointOf(scaled_));
    if (!solver_.log_->Note(record, free)) {
      // After an abort Ceres would return its starting point.
      is_stopped_ = true;
      return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }
    if (!iteration.step_is_successful || iteration.iteration == 0) {
      return ceres::SOLVER_CONTINUE;
    }
    const bool crawls =
        std::abs(iteration.cost_change) < limits_.crawl * iteration.cost;
    crawling_steps_ = crawls ? crawling_steps_ + 1 : 0;
    valley_.Note(iteration.cost_change, iteration.cost);
    return valley_.IsOne() ||
                   crawling_steps_ >= context_.tuning().solve.crawling_steps ||
                   solver_.IsSettled(free, bounded_.system(), limits_)
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

  // True if the steps ended in a valley.
  bool is_in_valley() const { return valley_.IsOne(); }
  // True if the caller asked for an end.
  bool is_stopped() const { return is_stopped_; }

 private:
  const Solver& solver_;
  const FitContext& context_;
  const BoundedCost& bounded_;
  const BentCost* bent_;
  const Vector& scaled_;
  const Limits& limits_;
  double* radius_;
  int crawling_steps_ = 0;  // one after the other
  Valley valley_;
  int first_iteration_;
  bool is_stopped_ = false;
};

Solver::Solver(const FitContext& context, FitLog* log)
    : context_(context), log_(log) {
  ResetRadius();
}

void Solver::ResetRadius() { radius_ = FirstRadius(context_); }

bool Solver::IsBelow(double residual, const Vector& free) const {
  MultipleShooting& shooting = context_.objective.shooting();
  const std::vector<Vector>* squares = shooting.state().SquaresAt(free);
  if (squares == nullptr) return false;
  double sum = 0.0;
  double count = 0.0;
  for (size_t t = 0; t < squares->size(); ++t) {
    const IdentificationRecord& record = context_.train_record(t);
    sum += (*squares)[t]
               .cwiseQuotient(shooting.record(t).sigmas().cwiseAbs2())
               .sum();
    for (size_t c = 0; c < record.channels.size(); ++c) {
      if (!record.channels[c].fit) continue;
      count += static_cast<double>(shooting.record(t).measured()[c].count);
    }
  }
  return sum < residual * residual * count;
}

bool Solver::IsSettled(const Vector& free, const CondensedSystem& system,
                       const Limits& limits) const {
  return (limits.residual > 0.0 && IsBelow(limits.residual, free)) ||
         (!context_.HasNetworks() &&
          MeasureOptimality(context_.layout, free, system).promise <
              limits.function_tolerance);
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
  log_->Note(record, state->free);
  state->optimality = MeasureOptimality(context_.layout, state->free, system);
}

bool Solver::Solve(const Limits& limits, FitState* state, bool* converged) {
  *converged = false;
  is_in_valley_ = false;
  Objective& objective = context_.objective;
  const bool bends = objective.shooting().KeepRows(
      BendsSteps(context_.problem, context_.layout));
  ceres::Solver::Options options =
      SolverOptions(context_, bends, limits.function_tolerance, radius_);
  options.max_num_iterations =
      std::min(limits.iterations, context_.options.max_num_iterations -
                                      context_.summary.num_iterations);
  if (options.max_num_iterations <= 0) return true;

  const int n = context_.layout.num_free();
  const auto begin = std::chrono::steady_clock::now();
  BoundedCost bounded(context_.layout, state->free, &objective);
  log_->AddJacobianSeconds(SecondsSince(begin));
  if (!bounded.IsValid()) {
    log_->SetMessage(objective.Failure());
    return false;
  }
  Vector scaled = bounded.Scaled(state->free);
  if (IsSettled(state->free, bounded.system(), limits)) {
    *converged = true;
    CondensedSystem steps;
    if (!bounded.Linearize(scaled, &steps)) return false;
    Settle(bounded.system(), steps.gradient.norm(), state);
    return true;
  }
  radius_ = options.initial_trust_region_radius;
  std::optional<BentCost> bent;
  if (bends) {
    bent.emplace(&bounded, BendOf(&objective, &bounded), &radius_);
  }
  CondensedCost cost(bends ? static_cast<CostPart*>(&*bent) : &bounded, n);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(&cost, nullptr, scaled.data());
  SetBounds(bounded, scaled.data(), &problem);

  Callback callback(*this, bounded, bends ? &*bent : nullptr, scaled, limits,
                    &radius_);
  options.callbacks.push_back(&callback);

  ceres::Solver::Summary ceres_summary;
  ceres::Solve(options, &problem, &ceres_summary);
  log_->AddJacobianSeconds(cost.jacobian_seconds());
  log_->AddLinearSolverSeconds(ceres_summary.linear_solver_time_in_seconds);
  log_->AddFailedEvaluations(cost.failed_evaluations());
  VLOG(2) << ceres_summary.FullReport();
  if (ceres_summary.termination_type == ceres::FAILURE &&
      ceres_summary.iterations.size() <= 1) {
    std::string message = objective.Failure();
    if (message.empty()) {
      message =
          "the equations of a step cannot be solved: residuals or derivatives "
          "are too large for numbers";
    }
    log_->SetMessage(std::move(message));
    return false;
  }
  if (bends) scaled = bent->PointOf(scaled);
  state->free = bounded.Unscaled(scaled);
  is_in_valley_ = callback.is_in_valley();
  *converged = !callback.is_stopped() && !is_in_valley_ &&
               (ceres_summary.termination_type == ceres::CONVERGENCE ||
                ceres_summary.termination_type == ceres::USER_SUCCESS);
  CondensedSystem system;
  // A stopped fit needs no derivatives.
  if (!(callback.is_stopped() ? objective.Evaluate(state->free, &system.cost)
                              : objective.Linearize(state->free, &system))) {
    log_->SetMessage(objective.Failure());
    return false;
  }
  state->cost = system.cost;
  if (*converged) {
    state->optimality = MeasureOptimality(context_.layout, state->free, system);
    VLOG(1) << ceres_summary.iterations.size() << " iterations, cost "
            << state->cost << ", cosine " << state->optimality.cosine
            << ", promise " << state->optimality.promise;
  }
  return true;
}

bool Solver::Polish(FitState* state) {
  constexpr int kMostSteps = 2;
  // Smallest visible change, as a share of the cost.
  constexpr double kLeastPromise = 1e-12;
  // Damping that keeps undetermined directions in place.
  constexpr double kDamping = 1e-6;
  Objective& objective = context_.objective;
  const auto fail = [&]() {
    log_->SetMessage(objective.Failure());
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
