#include "pinode/study/identify/step_check.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/record_grid.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/problem/substeps.h"

namespace pinode {
namespace {

constexpr double kShift = 0.1;  // deviations
constexpr int kMostSteps = 64;
// A refinement makes a fit at most this much dearer.
constexpr double kLargestFactor = 8.0;

bool TakesSteps(const IdentificationProblem& problem) {
  return std::any_of(
      problem.records.begin(), problem.records.end(),
      [&problem](const IdentificationRecord& record) {
        return record.role == IdentificationRecord::Role::kTrain &&
               IntegratorOf(*problem.dynamics, record) != Integrator::kExact;
      });
}

IdentificationProblem WithHalvedSteps(IdentificationProblem problem) {
  for (IdentificationRecord& record : problem.records) {
    record.substeps *= 2;
    record.exponential_steps *= 2;
  }
  return problem;
}

bool Linearize(const IdentificationProblem& problem, const FitSummary& summary,
               const IdentifiedModel& model, int num_threads,
               CondensedSystem* system) {
  const ParameterLayout layout(problem);
  MultipleShooting::Options options;
  options.num_threads = num_threads;
  Objective objective(problem, layout, options);
  return PlaceAtFit(problem, layout, model, summary.records, &objective) &&
         objective.Linearize(layout.Free(model.parameters), system);
}

}  // namespace

std::string StepCheck::Sentence() const {
  return "half the step would move '" + parameter + "' by " +
         FormatNumber(change, 3) + " (" + FormatNumber(shift, 2) +
         " times its standard deviation)";
}

bool CheckStepsAtFit(const IdentificationProblem& problem,
                     const FitSummary& summary, const IdentifiedModel& model,
                     int num_threads, StepCheck* check) {
  *check = StepCheck();
  if (!TakesSteps(problem) || !problem.dynamics->networks().empty() ||
      !problem.dynamics->unknown_forces().empty()) {
    return false;
  }
  const ParameterLayout layout(problem);
  CondensedSystem coarse, fine;
  if (!Linearize(problem, summary, model, num_threads, &coarse) ||
      !Linearize(WithHalvedSteps(problem), summary, model, num_threads,
                 &fine)) {
    return false;
  }
  const Vector step =
      SolveInformation(fine.hessian, coarse.gradient - fine.gradient);
  if (step.size() == 0 || !step.allFinite()) return false;
  bool seen = false;
  for (const ParameterEstimate& estimate : summary.parameters) {
    const int j = layout.FreeIndex(estimate.name);
    if (j < 0 || !(estimate.sigma > 0.0) || !std::isfinite(estimate.sigma) ||
        estimate.at_bound) {
      continue;
    }
    seen = true;
    const double shift = std::abs(step[j]) / estimate.sigma;
    if (!(shift > check->shift)) continue;
    const bool is_factor = layout.free()[static_cast<size_t>(j)] <
                           static_cast<int>(problem.dynamics->groups().size());
    check->parameter = estimate.name;
    check->shift = shift;
    check->change = step[j];
    check->is_large =
        std::abs(step[j]) >
        limits::kStepShare * (is_factor ? 1.0 : std::abs(estimate.value));
  }
  return seen;
}

bool RefineSteps(const StepCheck& check, IdentificationProblem* problem) {
  if (!(check.shift > kShift)) return false;
  const double factor = std::min(
      std::sqrt(std::sqrt(2.0 * check.shift / kShift)), kLargestFactor);
  const auto is_chosen_training = [](const IdentificationRecord& record) {
    return record.role == IdentificationRecord::Role::kTrain &&
           record.substeps_chosen;
  };
  // Hold-outs follow training records. The shift is that of these.
  if (std::none_of(problem->records.begin(), problem->records.end(),
                   is_chosen_training)) {
    return false;
  }
  bool changed = false;
  for (IdentificationRecord& record : problem->records) {
    if (!record.substeps_chosen) continue;
    const Integrator integrator = IntegratorOf(*problem->dynamics, record);
    const bool runge_kutta = integrator == Integrator::kRungeKutta;
    if (integrator == Integrator::kExact ||
        (runge_kutta && !(check.shift > limits::kNotedStepShift))) {
      continue;
    }
    int* steps = runge_kutta ? &record.substeps : &record.exponential_steps;
    const int finer = std::min(runge_kutta ? kMaxSubsteps : kMostSteps,
                               static_cast<int>(std::ceil(factor * *steps)));
    changed = changed || (is_chosen_training(record) && finer > *steps);
    *steps = std::max(*steps, finer);
  }
  return changed;
}

SettledSteps SettleSteps(const IdentificationOptions& options, InnerFit* fit,
                         IdentificationProblem* problem, FitSummary* summary,
                         IdentifiedModel* model) {
  constexpr int kMostRefinements = 2;
  SettledSteps settled;
  StepCheck check;
  for (int round = 0;; ++round) {
    if (!CheckStepsAtFit(*problem, *summary, *model, options.num_threads,
                         &check)) {
      return settled;
    }
    if (round == 0) settled.were_long = check.shift > limits::kNotedStepShift;
    if (round == kMostRefinements || !RefineSteps(check, problem)) break;
    IdentificationOptions near = options;
    BeginNearTheEnd(&near);
    const FitHistory history = FitHistory::Of(*summary);
    const IdentifiedModel begin = *model;
    fit->Run("finer steps", *problem, near, &begin, summary, model);
    history.Enter(summary);
    // Its own findings say why it ends here.
    settled.refined = true;
    if (!CheckFit(options.tuning.gaps, *summary).empty()) return settled;
  }
  if (check.shift > limits::kStepShift && check.is_large) {
    settled.findings = {
        {"long_steps", "the steps are too long: " + check.Sentence(),
         check.shift, limits::kStepShift, "increase `substeps`"}};
  } else if (check.shift > limits::kNotedStepShift) {
    summary->remarks.push_back("The integration steps are long: " +
                               check.Sentence() + ". Increase `substeps`.");
  }
  return settled;
}

}  // namespace pinode
