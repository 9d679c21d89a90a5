#include "pinode/study/damage/baseline.h"

#include <algorithm>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/problem/motion_levels.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

// Returns the position of a name; -1 if it is missing.
Eigen::Index PositionOf(const std::string& name,
                        const std::vector<std::string>& names) {
  const auto position = std::find(names.begin(), names.end(), name);
  return position == names.end() ? -1 : position - names.begin();
}

// True if the values could as well be those of another start, of whatever
// size. Mirrored elements of a beam have one set of frequencies.
bool HasOtherSolution(const Verdict& verdict) {
  const std::vector<Finding>& findings = verdict.findings();
  return std::any_of(
      findings.begin(), findings.end(),
      [](const Finding& finding) { return finding.check == "other_solution"; });
}

// True if a mode that the fit left out is the only reason for care, such as a
// pole of the wind, and nothing else is likely. The values then stand on the
// other modes.
bool HasOnlyUnusedModes(const IdentificationSummary& summary) {
  const std::vector<Finding>& findings = summary.verdict.findings();
  return std::all_of(findings.begin(), findings.end(),
                     [](const Finding& finding) {
                       return finding.check == "mode_not_used" ||
                              finding.grade != Grade::kWithCare;
                     }) &&
         std::none_of(summary.explanations.begin(), summary.explanations.end(),
                      [](const Explanation& explanation) {
                        return explanation.log_odds >= limits::kLogOdds;
                      });
}

}  // namespace

std::vector<std::string> FreeGroups(const StructuralDynamics& dynamics) {
  std::vector<std::string> names;
  for (const GroupTerm& term : dynamics.groups()) {
    if (term.alpha.free && term.follows == GroupTerm::Follows::kNothing) {
      names.push_back(term.group.name);
    }
  }
  return names;
}

std::vector<std::string> Followers(const StructuralDynamics& dynamics,
                                   bool free) {
  const std::vector<std::string> all = dynamics.CovariateParameters();
  std::vector<std::string> names;
  for (const ParameterBlock& block : dynamics.blocks()) {
    for (const Parameter& parameter : block.parameters) {
      if (parameter.free == free && PositionOf(parameter.name, all) >= 0) {
        names.push_back(parameter.name);
      }
    }
  }
  return names;
}

std::string FollowingText(const std::string& covariate, double reference,
                          const std::vector<double>& knots) {
  std::string text = covariate + " from " + FormatNumber(reference, 9);
  for (size_t k = 0; k < knots.size(); ++k) {
    text += (k == 0 ? " by knots at " : ", ") + FormatNumber(knots[k], 9);
  }
  return text;
}

bool MissesMotion(const Verdict& verdict) {
  const std::vector<Finding>& findings = verdict.findings();
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) {
                       return finding.check == kUnexplainedMotion;
                     });
}

Doubts DoubtsOf(const IdentificationSummary& summary) {
  Doubts doubts;
  if (summary.verdict.grade() != Grade::kWithCare) return doubts;
  if (HasOnlyUnusedModes(summary)) return doubts;
  doubts.other_solution = HasOtherSolution(summary.verdict);
  const bool misses_motion = MissesMotion(summary.verdict);
  for (const ParameterEstimate& own : summary.parameters) {
    ExplainedValue doubt{own.name, own.value, own.value - own.half_width95,
                         own.value + own.half_width95};
    if (misses_motion) {
      doubt.lower95 = std::min(doubt.lower95, own.lower95);
      doubt.upper95 = std::max(doubt.upper95, own.upper95);
    }
    for (const Explanation& explanation : summary.explanations) {
      // Those with about the odds of the best are not told from it.
      if (explanation.log_odds < limits::kLogOdds ||
          explanation.log_odds <
              summary.explanations[0].log_odds - limits::kLogOdds) {
        break;
      }
      for (const ExplainedValue& value : explanation.values) {
        if (value.name != own.name) continue;
        doubt.lower95 = std::min(doubt.lower95, value.lower95);
        doubt.upper95 = std::max(doubt.upper95, value.upper95);
      }
    }
    doubts.reach.push_back(std::move(doubt));
  }
  if (!summary.explanations.empty()) {
    const Explanation& likeliest = summary.explanations[0];
    if (likeliest.log_odds > limits::kLogOdds &&
        likeliest.leaves < limits::kNotedUnexplained) {
      doubts.whole = likeliest;
    }
  }
  doubts.misses_motion = misses_motion;
  return doubts;
}

std::map<std::string, std::string> FollowingTexts(
    const StructuralDynamics& dynamics) {
  std::map<std::string, std::string> texts;
  const auto name_of = [&dynamics](int input) {
    return dynamics.inputs()[static_cast<size_t>(input)].name;
  };
  for (const GroupTerm& term : dynamics.groups()) {
    if (term.follows != GroupTerm::Follows::kCovariate) continue;
    texts[term.group.name] =
        FollowingText(name_of(term.input), term.reference, {});
  }
  for (const GroupCurve& curve : dynamics.group_curves()) {
    const std::string text = FollowingText(
        name_of(curve.input), curve.knots[static_cast<size_t>(curve.reference)],
        curve.knots);
    for (const Parameter& parameter : curve.parameters.parameters) {
      texts[parameter.name] = text;
    }
  }
  return texts;
}

bool BaselineFrom(const std::string& name, const IdentificationProblem& problem,
                  const IdentificationSummary& summary,
                  const IdentifiedModel& model, Baseline* baseline,
                  std::string* error) {
  if (!IsUsableResultOf(problem, summary, model, error)) {
    *error = "baseline '" + name + "': " + *error;
    return false;
  }
  Baseline result;
  result.name = name;
  result.group_names = FreeGroups(*problem.dynamics);
  if (result.group_names.empty()) {
    *error = "baseline '" + name + "': no group is free";
    return false;
  }
  result.undetermined = summary.undetermined;
  result.followers = Followers(*problem.dynamics, /*free=*/true);
  const std::map<std::string, std::string> texts =
      FollowingTexts(*problem.dynamics);
  for (const std::string& follower : result.followers) {
    result.following.push_back(texts.at(follower));
  }
  std::vector<std::string> all = result.group_names;
  all.insert(all.end(), result.followers.begin(), result.followers.end());
  if (!GroupsOf(*problem.dynamics, summary, result.group_names, &result.groups,
                error) ||
      !GroupsOf(*problem.dynamics, summary, all, &result.with_followers,
                error)) {
    *error = "baseline '" + name + "': " + *error;
    return false;
  }
  const ParameterLayout layout(problem);
  std::vector<double> values;
  for (int i = 0; i < layout.num_parameters(); ++i) {
    if (!layout.IsNamed(i)) continue;
    result.parameter_names.push_back(layout.parameter(i).name);
    values.push_back(model.parameters[i]);
  }
  result.parameter_values = Eigen::Map<const Vector>(
      values.data(), static_cast<Eigen::Index>(values.size()));
  result.doubts = DoubtsOf(summary);
  result.levels = MotionLevels(problem);
  result.has_records =
      problem.num_train_records() > 0 || !problem.ambient.empty();
  HealthyFit fit;
  fit.problem = problem;
  fit.summary = summary;
  fit.model = model;
  result.fit = std::make_shared<const HealthyFit>(std::move(fit));
  *baseline = std::move(result);
  return true;
}

bool AreDifferentResults(const std::vector<Baseline>& baselines,
                         std::string* error) {
  for (size_t i = 0; i < baselines.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (baselines[i].groups.values != baselines[j].groups.values ||
          baselines[i].groups.covariance != baselines[j].groups.covariance) {
        continue;
      }
      *error = "baselines '" + baselines[j].name + "' and '" +
               baselines[i].name +
               "' are the same result, expected one result per record";
      return false;
    }
  }
  return true;
}

bool AreBaselinesOf(const StructuralDynamics& dynamics,
                    const std::vector<Baseline>& baselines,
                    std::string* error) {
  const std::vector<std::string> groups = FreeGroups(dynamics);
  const auto size = static_cast<Eigen::Index>(groups.size());
  for (const Baseline& baseline : baselines) {
    const GroupState& state = baseline.groups;
    if (baseline.group_names != groups) {
      *error = "baseline '" + baseline.name + "' has the groups " +
               Join(baseline.group_names, ", ") + ", expected " +
               Join(groups, ", ");
      return false;
    }
    if (state.values.size() != size || state.covariance.rows() != size ||
        state.covariance.cols() != size || !state.values.allFinite() ||
        !state.covariance.allFinite()) {
      *error =
          "baseline '" + baseline.name +
          "' has no finite value and covariance for every group; fit it again";
      return false;
    }
    const std::map<std::string, std::string> texts = FollowingTexts(dynamics);
    for (size_t i = 0; i < baseline.followers.size(); ++i) {
      const auto own = texts.find(baseline.followers[i]);
      if (own == texts.end() || baseline.following.size() <= i ||
          own->second == baseline.following[i]) {
        continue;
      }
      *error = "in baseline '" + baseline.name + "' '" + own->first +
               "' follows " + baseline.following[i] + ", expected " +
               own->second;
      return false;
    }
    const GroupState& all = baseline.with_followers;
    const Eigen::Index with_followers =
        size + static_cast<Eigen::Index>(baseline.followers.size());
    if (!baseline.followers.empty() &&
        (all.values.size() != with_followers ||
         all.covariance.rows() != with_followers ||
         all.covariance.cols() != with_followers || !all.values.allFinite() ||
         !all.covariance.allFinite())) {
      *error = "baseline '" + baseline.name +
               "' has no finite value and covariance of the coefficients of "
               "covariates; fit it again";
      return false;
    }
  }
  return AreDifferentResults(baselines, error);
}

IdentifiedModel BeginFromBaseline(const Baseline& baseline,
                                  const IdentificationProblem& problem) {
  const ParameterLayout layout(problem);
  const Vector present =
      AlreadyPresent(*problem.dynamics, baseline.group_names);
  IdentifiedModel model;
  model.parameters = layout.InitialValues();
  for (const int index : layout.free()) {
    const Parameter& parameter = layout.parameter(index);
    const Eigen::Index name =
        PositionOf(parameter.name, baseline.parameter_names);
    if (!layout.IsNamed(index) || name < 0) continue;
    double value = baseline.parameter_values[name];
    const Eigen::Index group = PositionOf(parameter.name, baseline.group_names);
    if (group >= 0 && baseline.offsets.size() > 0) {
      value += baseline.offsets[group];
    } else if (group >= 0) {
      value = baseline.groups.values[group] - present[group];
    }
    model.parameters[index] =
        std::clamp(value, parameter.lower, parameter.upper);
  }
  return model;
}

Vector AlreadyPresent(const StructuralDynamics& dynamics,
                      const std::vector<std::string>& names) {
  Vector present = Vector::Zero(static_cast<Eigen::Index>(names.size()));
  for (const GroupTerm& term : dynamics.groups()) {
    const Eigen::Index i = PositionOf(term.group.name, names);
    if (i >= 0) present[i] = term.present - 1.0;
  }
  return present;
}

bool GroupsOf(const StructuralDynamics& dynamics, const FitSummary& summary,
              const std::vector<std::string>& names, GroupState* state,
              std::string* error) {
  GroupState result;
  result.values = Vector::Zero(static_cast<Eigen::Index>(names.size()));
  std::vector<Eigen::Index> rows;
  for (size_t i = 0; i < names.size(); ++i) {
    const Eigen::Index row = PositionOf(names[i], summary.covariance_names);
    if (row < 0 || row >= summary.covariance.rows() ||
        row >= summary.covariance.cols()) {
      *error = "'" + names[i] + "' has no covariance";
      return false;
    }
    rows.push_back(row);
    for (const ParameterEstimate& parameter : summary.parameters) {
      if (parameter.name != names[i]) continue;
      result.values[static_cast<Eigen::Index>(i)] = parameter.value;
    }
  }
  result.values += AlreadyPresent(dynamics, names);
  result.covariance = summary.covariance(rows, rows);
  *state = std::move(result);
  return true;
}

}  // namespace pinode
