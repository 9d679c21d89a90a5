#include "pinode/study/damage/held_followers.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool AllKnow(const std::vector<Baseline>& baselines, const std::string& name) {
  return std::all_of(baselines.begin(), baselines.end(),
                     [&name](const Baseline& baseline) {
                       return Contains(baseline.followers, name);
                     });
}

// Returns those of `names` that all baselines determine; all knots of a curve
// or none.
std::vector<std::string> KnownByAll(const std::vector<Baseline>& baselines,
                                    const StructuralDynamics& dynamics,
                                    const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const std::string& name : names) {
    if (AllKnow(baselines, name)) known.push_back(name);
  }
  for (const GroupCurve& curve : dynamics.group_curves()) {
    const std::vector<Parameter>& knots = curve.parameters.parameters;
    if (std::all_of(knots.begin(), knots.end(), [&](const Parameter& knot) {
          return Contains(known, knot.name);
        })) {
      continue;
    }
    for (const Parameter& knot : knots) {
      known.erase(std::remove(known.begin(), known.end(), knot.name),
                  known.end());
    }
  }
  return known;
}

// Returns the row of a follower among a baseline's groups and followers.
Eigen::Index RowOf(const Baseline& baseline, const std::string& follower) {
  const auto at =
      std::find(baseline.followers.begin(), baseline.followers.end(), follower);
  return baseline.groups.values.size() + (at - baseline.followers.begin());
}

}  // namespace

std::map<std::string, double> FollowersToHold(
    const std::vector<Baseline>& baselines,
    const IdentificationProblem& problem) {
  std::map<std::string, double> held;
  if (problem.num_train_records() > 0) return held;
  const ParameterLayout layout(problem);
  const std::vector<std::string> followers =
      KnownByAll(baselines, *problem.dynamics,
                 Followers(*problem.dynamics, /*free=*/true));
  for (const int index : layout.free()) {
    const Parameter& parameter = layout.parameter(index);
    if (!Contains(followers, parameter.name) || parameter.HasPrior()) continue;
    double weights = 0.0;
    double sum = 0.0;
    for (const Baseline& baseline : baselines) {
      const Eigen::Index row = RowOf(baseline, parameter.name);
      const GroupState& state = baseline.with_followers;
      const double weight = 1.0 / state.covariance(row, row);
      weights += weight;
      sum += weight * state.values[row];
    }
    held[parameter.name] =
        std::clamp(sum / weights, parameter.lower, parameter.upper);
  }
  return held;
}

HeldFollowers::HeldFollowers(const std::vector<Baseline>& baselines,
                             const IdentificationProblem& problem) {
  const ParameterLayout layout(problem);
  const std::vector<std::string> fixed =
      KnownByAll(baselines, *problem.dynamics,
                 Followers(*problem.dynamics, /*free=*/false));
  std::vector<double> values;
  for (int i = 0; i < layout.num_dynamics(); ++i) {
    const Parameter& parameter = layout.parameter(i);
    if (!Contains(fixed, parameter.name)) continue;
    names_.push_back(parameter.name);
    values.push_back(parameter.value);
  }
  held_ = Eigen::Map<const Vector>(values.data(),
                                   static_cast<Eigen::Index>(values.size()));
}

bool HeldFollowers::FindSlopes(const FitOfRecords& fit,
                               const std::vector<std::string>& groups,
                               const std::vector<ChangeCandidate>& candidates,
                               int num_threads, std::string* error) {
  FitOfRecords extended = fit;
  IdentifiedModel at;
  if (!WithCandidates(fit, candidates, &extended.problem, &at, error)) {
    return false;
  }
  extended.problem.dynamics = std::make_shared<const StructuralDynamics>(
      extended.problem.dynamics->WithGroupParameters(
          [this](Parameter* parameter) {
            if (Contains(names_, parameter->name)) parameter->free = true;
          }));
  const ParameterLayout layout(extended.problem);
  CondensedSystem system;
  Matrix root, null_space;
  std::vector<int> held, others;
  for (int j = 0; j < layout.num_free(); ++j) {
    (Contains(names_, layout.free_parameter(j).name) ? held : others)
        .push_back(j);
  }
  if (!LinearizeAtFit(extended.problem, layout, at, fit.summary.records,
                      num_threads, &system) ||
      !InvertInformation(system.hessian(others, others), &root, &null_space,
                         InformationRounding(fit.problem))) {
    *error = "the model with free coefficients of covariates is not finite";
    return false;
  }
  const Matrix slopes =
      -root * (root.transpose() * system.hessian(others, held));
  // One row for each of these. Columns are in the order of the layout, which is
  // also the order of names_.
  std::vector<std::pair<std::string, double>> wanted;
  for (const std::string& group : groups) wanted.emplace_back(group, 1.0);
  for (const ChangeCandidate& candidate : candidates) {
    wanted.emplace_back(candidate.subject.name, candidate.unit);
  }
  slopes_.resize(static_cast<Eigen::Index>(wanted.size()), slopes.cols());
  for (size_t i = 0; i < wanted.size(); ++i) {
    const auto& [name, unit] = wanted[i];
    const auto other =
        std::find(others.begin(), others.end(), layout.FreeIndex(name));
    if (other == others.end()) {
      *error = "'" + name + "' is not free in " + fit.name;
      return false;
    }
    slopes_.row(static_cast<Eigen::Index>(i)) =
        slopes.row(other - others.begin()) / unit;
  }
  return true;
}

GroupState HeldFollowers::Compared(const GroupState& healthy,
                                   size_t num_groups) const {
  const auto groups = static_cast<Eigen::Index>(num_groups);
  const Eigen::Index followers = held_.size();
  const Eigen::Index candidates = healthy.values.size() - groups - followers;
  Matrix map = Matrix::Zero(groups + candidates, healthy.values.size());
  map.leftCols(groups).topRows(groups).setIdentity();
  map.rightCols(candidates).bottomRows(candidates).setIdentity();
  map.middleCols(groups, followers) = -slopes_;
  Vector values = healthy.values;
  values.segment(groups, followers) -= held_;
  return {map * values, map * healthy.covariance * map.transpose()};
}

GroupState HeldFollowers::StateOf(const Baseline& baseline) const {
  std::vector<int> rows;
  for (Eigen::Index i = 0; i < baseline.groups.values.size(); ++i) {
    rows.push_back(static_cast<int>(i));
  }
  for (const std::string& name : names_) {
    rows.push_back(static_cast<int>(RowOf(baseline, name)));
  }
  const GroupState& all = baseline.with_followers;
  return {all.values(rows), all.covariance(rows, rows)};
}

}  // namespace pinode
