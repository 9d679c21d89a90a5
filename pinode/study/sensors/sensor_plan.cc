#include "pinode/study/sensors/sensor_plan.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/certainty/null_space.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

// Deviation of a target that counts as unknown, see WithUnseenGroups.
constexpr double kUnknown = 10.0;
// Ridge relative to the information of all sensors together: other unknowns are
// never fully unknown.
constexpr double kRidge = 1e-10;
// Smallest gain of an exchange, in logarithms of deviations.
constexpr double kLeastPlanGain = 1e-9;
constexpr int kMostExchanges = 1000;

struct Target {
  int free = 0;        // position among the free parameters
  double scale = 1.0;  // of its deviation
  std::string name;
};

// True if a parameter is the factor of a group that follows no covariate;
// *target is the matrix to which it adds.
bool IsPlainGroup(const StructuralDynamics& dynamics, const std::string& name,
                  MatrixGroup::Target* target) {
  for (const GroupTerm& term : dynamics.groups()) {
    if (term.group.name != name) continue;
    *target = term.group.target;
    return term.follows == GroupTerm::Follows::kNothing;
  }
  return false;
}

// Returns the free named parameters of the dynamics.
std::vector<int> NamedFree(const ParameterLayout& layout) {
  std::vector<int> named;
  for (int j = 0; j < layout.num_free_dynamics(); ++j) {
    if (layout.IsNamed(layout.free()[static_cast<size_t>(j)])) {
      named.push_back(j);
    }
  }
  return named;
}

bool FindTargets(const IdentificationProblem& problem,
                 const ParameterLayout& layout,
                 const std::vector<std::string>& names,
                 std::vector<Target>* targets, std::string* error) {
  std::vector<int> chosen;
  const std::vector<int> named = NamedFree(layout);
  std::vector<std::string> known;
  MatrixGroup::Target kind = MatrixGroup::Target::kStiffness;
  for (const int j : named) {
    known.push_back(layout.free_parameter(j).name);
    if (IsPlainGroup(*problem.dynamics, known.back(), &kind) &&
        kind != MatrixGroup::Target::kDamping) {
      chosen.push_back(j);
    }
  }
  if (chosen.empty()) chosen = named;
  if (!names.empty()) {
    chosen.clear();
    for (const std::string& name : names) {
      const auto place = std::find(known.begin(), known.end(), name);
      if (place == known.end()) {
        *error = "'" + name + "' is to be found, expected the name of a free " +
                 "parameter" + NameHint(name, known);
        return false;
      }
      chosen.push_back(named[static_cast<size_t>(place - known.begin())]);
    }
  }
  if (chosen.empty()) {
    *error = "no named parameter is free, expected one that is to be found";
    return false;
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  for (const int j : chosen) {
    const Parameter& parameter = layout.free_parameter(j);
    double scale = 1.0;
    if (!IsPlainGroup(*problem.dynamics, parameter.name, &kind)) {
      scale = std::abs(parameter.value);
      if (scale == 0.0 && parameter.HasPrior()) scale = parameter.prior_sigma;
    }
    targets->push_back({j, scale, parameter.name});
  }
  return true;
}

// Value of a set of sensors by its information.
class Criterion {
 public:
  Criterion(const PlanningInformation& information, std::vector<Target> targets,
            int num_free, SensorPlanOptions::Criterion kind)
      : information_(information),
        targets_(std::move(targets)),
        num_free_(num_free),
        kind_(kind) {
    SensorSum all(information, num_free);
    for (const SensorInformation& sensor : information.candidates) {
      all.Add(sensor);
    }
    const Vector known = all.Information().diagonal();
    // The other unknowns come first, so that the last block of the root is the
    // targets'.
    std::vector<bool> is_target(static_cast<size_t>(num_free), false);
    for (Target& target : targets_) {
      is_target[static_cast<size_t>(target.free)] = true;
      // Scale of a target without a size of its own: from the information of
      // all sensors.
      if (target.scale == 0.0) {
        target.scale = known[target.free] > 0.0
                           ? 1.0 / std::sqrt(known[target.free])
                           : 1.0;
      }
    }
    for (int j = 0; j < num_free; ++j) {
      if (!is_target[static_cast<size_t>(j)]) order_.push_back(j);
    }
    num_others_ = static_cast<Eigen::Index>(order_.size());
    for (const Target& target : targets_) order_.push_back(target.free);
    scale_.resize(static_cast<Eigen::Index>(order_.size()));
    ridge_.resize(scale_.size());
    for (Eigen::Index i = 0; i < scale_.size(); ++i) {
      const double all_say = known[order_[static_cast<size_t>(i)]];
      scale_[i] = i < num_others_
                      ? (all_say > 0.0 ? 1.0 / std::sqrt(all_say) : 1.0)
                      : targets_[static_cast<size_t>(i - num_others_)].scale;
      ridge_[i] = i < num_others_ ? kRidge : 1.0 / (kUnknown * kUnknown);
    }
  }

  // Returns the criterion; smaller is better. Fills *step except for its
  // candidate.
  double Evaluate(const SensorSum& sum, SensorPlan::Step* step) const {
    const Matrix whole = sum.Information();
    const auto n = static_cast<Eigen::Index>(order_.size());
    Matrix scaled(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = 0; k < n; ++k) {
        scaled(i, k) = scale_[i] * scale_[k] *
                       whole(order_[static_cast<size_t>(i)],
                             order_[static_cast<size_t>(k)]);
      }
    }
    scaled.diagonal() += ridge_;
    const Eigen::LLT<Matrix> root(scaled);
    if (root.info() != Eigen::Success) {
      return std::numeric_limits<double>::infinity();
    }
    const auto count = static_cast<Eigen::Index>(targets_.size());
    const Matrix lower = Matrix(root.matrixL()).bottomRightCorner(count, count);
    const double log_typical =
        -lower.diagonal().array().log().sum() / static_cast<double>(count);
    const Matrix inverse = lower.triangularView<Eigen::Lower>().solve(
        Matrix::Identity(count, count));
    Eigen::Index worst = 0;
    const double largest = inverse.colwise().norm().maxCoeff(&worst);
    if (step != nullptr) {
      step->typical = std::exp(log_typical);
      step->worst = largest;
      step->worst_name = targets_[static_cast<size_t>(worst)].name;
    }
    // The other targets still distinguish sensors if one target is
    // undetermined.
    return kind_ == SensorPlanOptions::Criterion::kDeterminant
               ? log_typical
               : std::log(largest) + 1e-3 * log_typical;
  }

  SensorSum Empty() const { return {information_, num_free_}; }

 private:
  const PlanningInformation& information_;
  std::vector<Target> targets_;
  const int num_free_;
  const SensorPlanOptions::Criterion kind_;
  std::vector<int> order_;
  Eigen::Index num_others_ = 0;
  Vector scale_, ridge_;
};

class Planner {
 public:
  // Plans in addition to `fixed`, the sensors that stay.
  Planner(const std::vector<SensorInformation>& candidates,
          const Criterion& criterion, const SensorSum& fixed)
      : candidates_(candidates), criterion_(criterion), fixed_(fixed) {}

  // Returns the best sensor in addition to `chosen`, out of `among` (empty:
  // all); -1: none is left.
  int Best(const std::vector<int>& chosen, const std::vector<int>& among,
           double* value) const {
    const SensorSum present = Sum(chosen);
    const int count =
        static_cast<int>(among.empty() ? candidates_.size() : among.size());
    int best = -1;
    for (int i = 0; i < count; ++i) {
      const int candidate = among.empty() ? i : among[static_cast<size_t>(i)];
      if (std::find(chosen.begin(), chosen.end(), candidate) != chosen.end()) {
        continue;
      }
      SensorSum with = present;
      with.Add(candidates_[static_cast<size_t>(candidate)]);
      const double own = criterion_.Evaluate(with, nullptr);
      if (best < 0 || own < *value) {
        best = candidate;
        *value = own;
      }
    }
    return best;
  }

  std::vector<int> Greedy(int count, const std::vector<int>& among) const {
    std::vector<int> chosen;
    double value = 0.0;
    while (static_cast<int>(chosen.size()) < count) {
      chosen.push_back(Best(chosen, among, &value));
    }
    return chosen;
  }

  // Exchanges sensors; returns the number of exchanges.
  int Exchange(std::vector<int>* chosen) const {
    double value = criterion_.Evaluate(Sum(*chosen), nullptr);
    int exchanges = 0;
    for (; exchanges < kMostExchanges; ++exchanges) {
      size_t out = 0;
      int in = -1;
      double best = value - kLeastPlanGain;
      for (size_t i = 0; i < chosen->size(); ++i) {
        std::vector<int> others = *chosen;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        double own = 0.0;
        const int candidate = Best(others, {}, &own);
        if (candidate >= 0 && own < best) {
          best = own;
          out = i;
          in = candidate;
        }
      }
      if (in < 0) break;
      (*chosen)[out] = in;
      value = best;
    }
    return exchanges;
  }

  double Value(const std::vector<int>& chosen) const {
    return criterion_.Evaluate(Sum(chosen), nullptr);
  }

  SensorPlan::Step StepOf(const std::vector<int>& chosen) const {
    SensorPlan::Step step;
    if (!chosen.empty()) step.candidate = chosen.back();
    criterion_.Evaluate(Sum(chosen), &step);
    return step;
  }

  SensorSum Sum(const std::vector<int>& chosen) const {
    SensorSum sum = fixed_;
    for (const int i : chosen) sum.Add(candidates_[static_cast<size_t>(i)]);
    return sum;
  }

 private:
  const std::vector<SensorInformation>& candidates_;
  const Criterion& criterion_;
  const SensorSum& fixed_;
};

SensorSum SumOf(const Criterion& criterion,
                const std::vector<SensorInformation>& sensors) {
  SensorSum sum = criterion.Empty();
  for (const SensorInformation& sensor : sensors) sum.Add(sensor);
  return sum;
}

// Computes deviations and null space as in pinode_check, without the sensors'
// own parameters unless `with_sensors`.
bool Assess(const IdentificationProblem& problem, const ParameterLayout& layout,
            const SensorSum& sum, bool with_sensors,
            std::vector<ExpectedDeviation>* expected,
            std::vector<std::string>* undetermined) {
  const int used =
      with_sensors ? layout.num_free() : layout.num_free_dynamics();
  const Matrix information = sum.Information().topLeftCorner(used, used);
  Matrix root = Matrix::Zero(used, used);
  Matrix null_space = Matrix::Identity(used, used);
  if (!information.isZero(0.0) &&
      !InvertInformation(information, &root, &null_space)) {
    return false;
  }
  Matrix covariance = Matrix::Zero(layout.num_free(), layout.num_free());
  covariance.topLeftCorner(used, used) = root * root.transpose();
  Matrix directions = Matrix::Zero(layout.num_free(), null_space.cols());
  directions.topRows(used) = null_space;
  directions =
      WithUnseenGroups(problem, layout, layout.Free(layout.InitialValues()),
                       covariance, directions);
  *expected = ExpectedDeviations(layout, covariance, directions);
  // Parameters of sensors, which come last, are left out.
  size_t named = 0;
  for (int j = 0; j < layout.num_free_dynamics(); ++j) {
    if (layout.IsNamed(layout.free()[static_cast<size_t>(j)])) ++named;
  }
  expected->resize(named);
  if (undetermined != nullptr) {
    *undetermined = DescribeNullSpace(layout, directions);
  }
  return true;
}

// Cuts the record to its first part; false if the duration does not fit.
bool CutRecord(double duration, IdentificationRecord* record,
               std::string* error) {
  const double step = record->sampling_step();
  const auto samples =
      static_cast<Eigen::Index>(std::floor(duration / step + 1e-6)) + 1;
  if (samples < 2 || samples > record->num_samples()) {
    *error =
        "a duration of " + FormatNumber(duration, 6) + " of record '" +
        record->name + "', expected one from " + FormatNumber(step, 6) +
        " to " +
        FormatNumber(step * static_cast<double>(record->num_samples() - 1), 6);
    return false;
  }
  const Excitation& whole = *record->excitation;
  Excitation cut(whole.start_time(), whole.step(),
                 whole.samples().leftCols(samples), whole.interpolation());
  record->excitation = std::move(cut);
  for (MeasuredChannel& channel : record->channels) {
    channel.values = channel.values.head(samples).eval();
  }
  return true;
}

}  // namespace

bool PlanSensors(const IdentificationProblem& problem,
                 const IdentificationOptions& options,
                 const std::vector<OwnSensor>& own,
                 const std::vector<CandidateSensor>& candidates,
                 const SensorPlanOptions& plan_options, SensorPlan* plan,
                 std::string* error) {
  *plan = SensorPlan();
  const ParameterLayout layout(problem);
  std::vector<Target> targets;
  if (plan_options.num_sensors < 1 ||
      plan_options.num_sensors > static_cast<int>(candidates.size())) {
    *error = std::to_string(plan_options.num_sensors) +
             " sensors are to be chosen, expected 1 to " +
             std::to_string(candidates.size()) +
             ", the number of places for them";
    return false;
  }
  if (!FindTargets(problem, layout, plan_options.targets, &targets, error) ||
      !LinearizeSensors(problem, options, own, candidates, &plan->information,
                        error)) {
    return false;
  }
  for (const Target& target : targets) plan->targets.push_back(target.name);
  const bool keeps = plan_options.keep_own;
  const Criterion criterion(plan->information, targets, layout.num_free(),
                            plan_options.criterion);
  const SensorSum own_sum = SumOf(criterion, plan->information.own);
  const SensorSum fixed = keeps ? own_sum : criterion.Empty();
  const Planner planner(plan->information.candidates, criterion, fixed);

  std::vector<int> chosen = planner.Greedy(plan_options.num_sensors, {});
  plan->num_exchanges = planner.Exchange(&chosen);
  if (plan_options.criterion == SensorPlanOptions::Criterion::kWorstDeviation) {
    // The worst target changes from step to step and misleads a greedy choice.
    // The plan by the determinant is another starting point.
    const Criterion volume(plan->information, targets, layout.num_free(),
                           SensorPlanOptions::Criterion::kDeterminant);
    std::vector<int> other =
        Planner(plan->information.candidates, volume, fixed)
            .Greedy(plan_options.num_sensors, {});
    const int exchanges = planner.Exchange(&other);
    if (planner.Value(other) < planner.Value(chosen)) {
      chosen = other;
      plan->num_exchanges = exchanges;
    }
  }
  // Order with the most informative sensor first.
  chosen = planner.Greedy(plan_options.num_sensors, chosen);
  plan->without = planner.StepOf({});
  for (size_t i = 1; i <= chosen.size(); ++i) {
    plan->steps.push_back(planner.StepOf(
        {chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(i)}));
  }
  criterion.Evaluate(own_sum, &plan->own);
  double value = 0.0;
  std::vector<int> more = chosen;
  more.push_back(planner.Best(chosen, {}, &value));
  if (more.back() >= 0) plan->next = planner.StepOf(more);

  if (!Assess(problem, layout, own_sum, true, &plan->by_own,
              &plan->undetermined_by_own) ||
      !Assess(problem, layout, planner.Sum(chosen), keeps, &plan->by_plan,
              &plan->undetermined_by_plan) ||
      !Assess(problem, layout, SumOf(criterion, plan->information.candidates),
              false, &plan->by_all, nullptr)) {
    *error = "the information of the sensors is not finite";
    return false;
  }
  return true;
}

bool PlanDurations(const IdentificationProblem& problem,
                   const IdentificationOptions& options,
                   const std::vector<OwnSensor>& own,
                   const std::vector<CandidateSensor>& candidates,
                   const SensorPlanOptions& plan_options,
                   const SensorPlan& plan, const std::vector<double>& durations,
                   std::vector<PlannedDuration>* reached, std::string* error) {
  reached->clear();
  const ParameterLayout layout(problem);
  std::vector<Target> targets;
  if (!FindTargets(problem, layout, plan_options.targets, &targets, error)) {
    return false;
  }
  // Noise stays as that of the whole records.
  std::vector<CandidateSensor> chosen;
  for (const SensorPlan::Step& step : plan.steps) {
    const auto i = static_cast<size_t>(step.candidate);
    chosen.push_back(candidates[i]);
    chosen.back().sigma = plan.information.candidates[i].sigma;
  }
  for (const double duration : durations) {
    IdentificationProblem cut = problem;
    for (size_t i = 0; i < own.size(); ++i) {
      cut.records[static_cast<size_t>(own[i].record)]
          .channels[static_cast<size_t>(own[i].channel)]
          .sigma = plan.information.own[i].sigma;
    }
    for (IdentificationRecord& record : cut.records) {
      if (record.role == IdentificationRecord::Role::kTrain &&
          !CutRecord(duration, &record, error)) {
        return false;
      }
    }
    PlanningInformation information;
    if (!LinearizeSensors(cut, options, own, chosen, &information, error)) {
      return false;
    }
    const Criterion criterion(information, targets, layout.num_free(),
                              plan_options.criterion);
    SensorSum sum = SumOf(criterion, information.candidates);
    for (const SensorInformation& sensor : information.own) {
      if (plan_options.keep_own) sum.Add(sensor);
    }
    PlannedDuration result;
    result.duration = duration;
    criterion.Evaluate(sum, &result.reached);
    reached->push_back(result);
  }
  return true;
}

}  // namespace pinode
