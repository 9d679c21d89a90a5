#include "pinode/estimate/levenberg_marquardt.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "pinode/estimate/bounded_step.h"

namespace pinode {
namespace {

// A step counts that brings this share of what it promises.
constexpr double kLeastQuality = 1e-3;
// Of the squared length of a column at the start: no diagonal is below.
constexpr double kLeastDiagonal = 1e-6;
constexpr double kMostRadius = 1e16;

class Stopwatch {
 public:
  explicit Stopwatch(double* seconds)
      : seconds_(seconds), begin_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() {
    *seconds_ +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_)
            .count();
  }

 private:
  double* seconds_;
  std::chrono::steady_clock::time_point begin_;
};

}  // namespace

LevenbergMarquardt::LevenbergMarquardt(const ParameterLayout& layout,
                                       const Options& options, CostPart* cost)
    : layout_(layout), options_(options), cost_(cost), radius_(options.radius) {
  for (int j = 0; j < layout.num_free(); ++j) {
    bounded_ = bounded_ || std::isfinite(layout.free_parameter(j).lower) ||
               std::isfinite(layout.free_parameter(j).upper);
  }
}

bool LevenbergMarquardt::Linearize(const Vector& free,
                                   CondensedSystem* system) {
  const Stopwatch watch(&outcome_.cost_seconds);
  const bool ok = cost_->Linearize(free, system);
  if (!ok) ++outcome_.failed_evaluations;
  return ok;
}

bool LevenbergMarquardt::Evaluate(const Vector& free, double* cost) {
  const Stopwatch watch(&outcome_.cost_seconds);
  const bool ok = cost_->Evaluate(free, cost) && std::isfinite(*cost);
  if (!ok) ++outcome_.failed_evaluations;
  return ok;
}

bool LevenbergMarquardt::FindStep(const Vector& free, double* promise) {
  const Stopwatch watch(&outcome_.solver_seconds);
  const Vector& gradient = system_.gradient;
  const Vector damping = system_.hessian.diagonal().cwiseMax(floor_) / radius_;
  factor_ = system_.hessian;
  factor_.diagonal() += damping;
  if (bounded_) {
    const int n = layout_.num_free();
    Vector lower(n), upper(n);
    for (int j = 0; j < n; ++j) {
      const Parameter& parameter = layout_.free_parameter(j);
      lower[j] = std::min(0.0, parameter.lower - free[j]);
      upper[j] = std::max(0.0, parameter.upper - free[j]);
    }
    if (!BoundedStep(factor_, gradient, lower, upper, &step_)) return false;
    *promise = -step_.dot(gradient) - 0.5 * step_.dot(system_.hessian * step_);
  } else {
    const Eigen::LLT<Eigen::Ref<Matrix>> factor(factor_);
    if (factor.info() != Eigen::Success) return false;
    step_ = -factor.solve(gradient);
    // The same, (H + D) step being -g.
    *promise =
        0.5 * (step_.dot(damping.cwiseProduct(step_)) - step_.dot(gradient));
  }
  return step_.allFinite() && *promise > 0.0;
}

double LevenbergMarquardt::Quality(double cost, double promise) const {
  return std::max((system_.cost - cost) / promise,
                  (reference_.cost - cost) / (reference_.promised + promise));
}

void LevenbergMarquardt::Accept(double cost, double promise, double quality) {
  radius_ = std::min(
      kMostRadius,
      radius_ / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * quality - 1.0, 3.0)));
  shrink_ = 2.0;
  candidate_.promised += promise;
  reference_.promised += promise;
  if (cost < lowest_) {
    lowest_ = cost;
    uphill_ = 0;
    candidate_ = {cost, 0.0};
  } else {
    ++uphill_;
    if (cost > candidate_.cost) candidate_ = {cost, 0.0};
  }
  if (uphill_ == options_.uphill_steps) reference_ = candidate_;
}

void LevenbergMarquardt::Reject() {
  radius_ /= shrink_;
  shrink_ *= 2.0;
}

LevenbergMarquardt::Outcome LevenbergMarquardt::Run(const Callback& callback,
                                                    Vector* free) {
  outcome_ = Outcome();
  Vector at = *free;
  if (!Linearize(at, &system_)) return outcome_;
  floor_ = kLeastDiagonal *
           (1.0 + system_.hessian.diagonal().array().max(0.0).sqrt()).square();
  lowest_ = system_.cost;
  reference_ = candidate_ = {system_.cost, 0.0};
  Iteration iteration;
  iteration.cost = system_.cost;
  iteration.gradient_norm = system_.gradient.norm();
  iteration.radius = radius_;
  int invalid = 0;
  for (;;) {
    outcome_.end = End::kStopped;
    if (!callback(iteration, system_, at)) return outcome_;
    outcome_.end = End::kIterations;
    if (iteration.number >= options_.max_iterations) return outcome_;
    ++iteration.number;
    outcome_.iterations = iteration.number;

    double promise = 0.0;
    double cost = 0.0;
    iteration.accepted = false;
    iteration.step_norm = 0.0;
    const bool has_step = FindStep(at, &promise);
    if (!has_step || !Evaluate(at + step_, &cost)) {
      if (++invalid > options_.most_invalid_steps) return outcome_;
      Reject();
      iteration.radius = radius_;
      continue;
    }
    invalid = 0;
    iteration.step_norm = step_.norm();
    outcome_.end = End::kConverged;
    if (std::abs(system_.cost - cost) <=
            options_.function_tolerance * system_.cost ||
        iteration.step_norm <= options_.parameter_tolerance *
                                   (at.norm() + options_.parameter_tolerance)) {
      return outcome_;
    }
    const double quality = Quality(cost, promise);
    const Vector next = at + step_;
    if (quality > kLeastQuality && Linearize(next, &next_)) {
      at = next;
      std::swap(system_, next_);
      Accept(cost, promise, quality);
      if (uphill_ == 0) *free = at;
      iteration.accepted = true;
      iteration.cost = system_.cost;
      iteration.gradient_norm = system_.gradient.norm();
    } else {
      Reject();
    }
    iteration.radius = radius_;
  }
}

}  // namespace pinode
