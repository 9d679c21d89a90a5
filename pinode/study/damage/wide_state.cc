#include "pinode/study/damage/wide_state.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/damage/baseline.h"
#include "pinode/study/problem/growth.h"

namespace pinode {

bool WithCandidates(const FitOfRecords& fit,
                    const std::vector<ChangeCandidate>& candidates,
                    IdentificationProblem* extended, IdentifiedModel* at,
                    std::string* error) {
  if (!IsFitOf(fit.problem, fit.summary, fit.model, error)) return false;
  const std::map<std::string, double> values =
      ParametersByName(fit.problem, fit.model);
  std::vector<ChangeCandidate> missing;
  for (const ChangeCandidate& candidate : candidates) {
    if (values.find(candidate.subject.name) == values.end()) {
      missing.push_back(candidate);
    }
  }
  if (!AddCandidates(fit.problem, missing, extended, error)) return false;
  *at = BeginFrom(values, fit.model, *extended);
  at->decays = fit.model.decays;
  return true;
}

double MissedOf(const FitSummary& summary, double least_share) {
  double largest = 0.0;
  for (const RecordScore& record : summary.records) {
    const double missed = StructuredError(record);
    if (record.role == IdentificationRecord::Role::kTrain &&
        missed >= least_share * record.nrmse) {
      largest = std::max(largest, missed);
    }
  }
  return largest;
}

void ScaleToUnits(const std::vector<ChangeCandidate>& candidates,
                  GroupState* state) {
  Vector unit = Vector::Ones(state->values.size());
  for (size_t j = 0; j < candidates.size(); ++j) {
    unit[unit.size() - static_cast<Eigen::Index>(candidates.size() - j)] =
        candidates[j].unit;
  }
  state->values = state->values.cwiseQuotient(unit);
  const auto inverse = unit.cwiseInverse().asDiagonal();
  state->covariance = inverse * state->covariance * inverse;
}

namespace {

// Gauss-Newton step from a fit with further unknowns.
struct Step {
  IdentificationProblem extended;
  IdentifiedModel at;
  Vector gradient;  // of minus the log-likelihood
  Matrix covariance;
};

bool FindStep(const FitOfRecords& fit,
              const std::vector<ChangeCandidate>& candidates, int num_threads,
              Step* step, std::string* error) {
  if (!WithCandidates(fit, candidates, &step->extended, &step->at, error)) {
    return false;
  }
  const ParameterLayout layout(step->extended);
  FittedCost cost;
  Matrix root, null_space;
  if (!LinearizeAtFit(step->extended, layout, step->at, fit.summary.records,
                      num_threads, &cost) ||
      !InvertInformation(cost.system.hessian / cost.memory, &root, &null_space,
                         InformationRounding(step->extended))) {
    *error = "the model with all kinds of change is not finite";
    return false;
  }
  step->covariance = root * root.transpose();
  step->gradient = cost.system.gradient / cost.memory;
  return true;
}

}  // namespace

bool PromiseOf(const FitOfRecords& fit,
               const std::vector<ChangeCandidate>& candidates, int num_threads,
               double* promise, std::string* error) {
  Step step;
  if (!FindStep(fit, candidates, num_threads, &step, error)) return false;
  *promise = 0.5 * step.gradient.dot(step.covariance * step.gradient);
  return true;
}

bool StateNear(const FitOfRecords& fit, const std::vector<std::string>& groups,
               const std::vector<ChangeCandidate>& candidates, int num_threads,
               GroupState* state, std::string* error) {
  Step step;
  if (!FindStep(fit, candidates, num_threads, &step, error)) return false;
  const ParameterLayout layout(step.extended);
  const Vector solution =
      layout.Free(step.at.parameters) - step.covariance * step.gradient;
  std::vector<std::string> names = groups;
  for (const ChangeCandidate& candidate : candidates) {
    names.push_back(candidate.subject.name);
  }
  std::vector<int> rows(names.size(), -1);
  for (const int index : layout.free()) {
    const auto name =
        std::find(names.begin(), names.end(), layout.parameter(index).name);
    if (name != names.end()) {
      rows[static_cast<size_t>(name - names.begin())] = layout.FreeIndex(index);
    }
  }
  for (size_t i = 0; i < names.size(); ++i) {
    if (rows[i] < 0) {
      *error = "'" + names[i] + "' is not free in " + fit.name;
      return false;
    }
  }
  state->values = solution(rows) + AlreadyPresent(*fit.problem.dynamics, names);
  state->covariance = step.covariance(rows, rows);
  ScaleToUnits(candidates, state);
  return true;
}

namespace {

// True for a change of what the equation of motion is linear in, and that the
// model has: 1 + alpha of it is present.
bool IsFactor(const ChangeCandidate& candidate) {
  return candidate.subject.kind == ChangeKind::kMass ||
         candidate.subject.kind == ChangeKind::kStiffness;
}

}  // namespace

std::vector<bool> ToLogarithms(size_t num_groups,
                               const std::vector<ChangeCandidate>& candidates,
                               std::vector<GroupState>* states) {
  const std::vector<bool> gone = NearlyGone(*states);
  std::vector<bool> is_logarithm(num_groups + candidates.size(), false);
  for (size_t j = 0; j < is_logarithm.size(); ++j) {
    if (gone[j] || (j >= num_groups && !IsFactor(candidates[j - num_groups]))) {
      continue;
    }
    is_logarithm[j] = true;
    const Eigen::Index i = static_cast<Eigen::Index>(j);
    for (GroupState& state : *states) {
      const double scale = 1.0 + state.values[i];
      state.values[i] = std::log(scale);
      state.covariance.row(i) /= scale;
      state.covariance.col(i) /= scale;
    }
  }
  return is_logarithm;
}

void FromLogarithm(double threshold, double baseline, GroupChange* change) {
  change->probability =
      0.5 * std::erfc((change->change - std::log1p(-threshold)) /
                      (change->sigma * std::sqrt(2.0)));
  change->sigma *= baseline * std::exp(change->change);
  change->change = baseline * std::expm1(change->change);
  change->lower95 = baseline * std::expm1(change->lower95);
  change->upper95 = baseline * std::expm1(change->upper95);
}

bool EstimateChangeByLogarithms(size_t num_groups,
                                const std::vector<ChangeCandidate>& candidates,
                                const std::vector<GroupState>& healthy,
                                const GroupState& current,
                                const ChangeOptions& options,
                                ChangeEstimate* estimate, std::string* error) {
  std::vector<GroupState> states = healthy;
  states.push_back(current);
  const std::vector<bool> is_logarithm =
      ToLogarithms(num_groups, candidates, &states);
  const GroupState now = states.back();
  states.pop_back();
  ChangeOptions by_logarithms = options;
  by_logarithms.absolute.resize(is_logarithm.size(), false);
  for (size_t j = 0; j < is_logarithm.size(); ++j) {
    if (is_logarithm[j]) by_logarithms.absolute[j] = true;
  }
  if (!EstimateChange(states, now, by_logarithms, estimate, error)) {
    return false;
  }
  for (size_t j = 0; j < is_logarithm.size(); ++j) {
    if (!is_logarithm[j]) continue;
    // The change of an added mass is a plain difference.
    double baseline = 1.0;
    if (j < options.absolute.size() && options.absolute[j]) {
      baseline = 0.0;
      for (const GroupState& state : healthy) {
        baseline += (1.0 + state.values[static_cast<Eigen::Index>(j)]) /
                    static_cast<double>(healthy.size());
      }
    }
    // Above its whole value nothing is lost; near zero all may be.
    const double threshold = std::min(options.threshold / baseline, 0.999);
    FromLogarithm(threshold, baseline, &estimate->groups[j]);
    estimate->between_records[static_cast<Eigen::Index>(j)] *= baseline;
  }
  return true;
}

}  // namespace pinode
