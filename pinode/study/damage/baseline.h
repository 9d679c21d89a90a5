// Baselines: fits of records of a known state, with which a new state is
// compared.

#ifndef PINODE_STUDY_DAMAGE_BASELINE_H_
#define PINODE_STUDY_DAMAGE_BASELINE_H_

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/damage/change.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Problem and fit of a baseline. They are needed to find changes of other kinds
// than changes of groups.
struct HealthyFit {
  IdentificationProblem problem;
  IdentificationOptions options;
  // Results of a fit of `problem`. If `model` has no parameters, the problem is
  // fitted first, from its own initial values.
  IdentificationSummary summary;
  IdentifiedModel model;

  bool IsFitted() const { return model.parameters.size() > 0; }
};

// Uncertainty of a result of grade "usable with care", beyond its intervals.
struct Doubts {
  // Values and widened intervals of named parameters. They include the
  // intervals under the likeliest explanations. If motion is unexplained, they
  // also include the result's own intervals, which allow for an incomplete
  // model. Empty if unused measured modes are the only reason for care and no
  // explanation has odds of 20.
  std::vector<ExplainedValue> reach = {};
  // True if another solution describes the data as well.
  bool other_solution = false;
  // True if motion is unexplained by the model as it is, whatever explains it.
  bool misses_motion = false;
  // Likeliest explanation, if only noise remains with it.
  std::optional<Explanation> whole = std::nullopt;
};

// Baseline: values of a known state, and the fit that they come from.
struct Baseline {
  // Name in messages and reports, such as the folder of its results.
  std::string name;
  // Names of the free groups that follow no covariate (FreeGroups), and their
  // values with covariance. The structure has 1 + value times the group's
  // matrix, see GroupTerm::present.
  std::vector<std::string> group_names;
  GroupState groups;
  // Names of the free parameters by which groups follow covariates (Followers).
  std::vector<std::string> followers;
  std::vector<std::string> following;  // FollowingText(), one each
  // Combinations of parameters that the records do not determine, see
  // FitSummary::undetermined.
  std::vector<std::string> undetermined;
  // Values of the groups and then of `followers`, with their joint covariance.
  GroupState with_followers;
  // Offsets between alphas of the new problem and `groups`, one per group. They
  // are not zero if the matrices of the new problem include the identified
  // changes. Empty: offsets follow from GroupTerm::present of the new problem.
  Vector offsets;
  // Names and values of all named parameters of the fit, also of fixed ones.
  std::vector<std::string> parameter_names;
  Vector parameter_values;

  Doubts doubts = {};  // see DoubtsOf
  // Levels of motion of the records. Empty: unknown.
  std::vector<MotionLevel> levels = {};
  // False for a fit to measured modes or frequency responses alone.
  bool has_records = true;

  // Fit of the baseline. Null if only the values are known; `why_no_fit` then
  // has the reason as a clause.
  std::shared_ptr<const HealthyFit> fit;
  std::string why_no_fit = "the baseline has no records";
};

// Returns the names of the groups to be compared: the free ones that follow no
// covariate.
std::vector<std::string> FreeGroups(const StructuralDynamics& dynamics);

// Returns the parameters by which groups follow covariates
// (CovariateParameters): the free ones if `free` is true, else the fixed ones.
std::vector<std::string> Followers(const StructuralDynamics& dynamics,
                                   bool free);

// Returns the way in which a group follows a covariate as text: "temperature
// from 20", or "temperature from 20 by knots at -10, 0, 20". Parameters can be
// compared only if their texts are equal.
std::string FollowingText(const std::string& covariate, double reference,
                          const std::vector<double>& knots);
// Returns the texts of all parameters of `dynamics` by which groups follow
// covariates, by name.
std::map<std::string, std::string> FollowingTexts(
    const StructuralDynamics& dynamics);

// True if one of the findings is unexplained motion.
bool MissesMotion(const Verdict& verdict);

// Returns the doubts about a result. Empty unless its grade is "usable with
// care".
Doubts DoubtsOf(const IdentificationSummary& summary);

// Makes a baseline from a usable fit with a covariance. Returns false, with
// *error, if the fit is not usable or if no group is free.
[[nodiscard]] bool BaselineFrom(const std::string& name,
                                const IdentificationProblem& problem,
                                const IdentificationSummary& summary,
                                const IdentifiedModel& model,
                                Baseline* baseline, std::string* error);

// Checks that no two baselines have the same numbers, because the scatter
// between baselines would be underestimated. Returns false, with *error, if two
// are identical.
[[nodiscard]] bool AreDifferentResults(const std::vector<Baseline>& baselines,
                                       std::string* error);

// Checks that the baselines can be compared with fits of `dynamics`: they have
// the same groups, these follow covariates in the same way, and values are
// finite. Also runs AreDifferentResults. Returns false, with *error, if not.
[[nodiscard]] bool AreBaselinesOf(const StructuralDynamics& dynamics,
                                  const std::vector<Baseline>& baselines,
                                  std::string* error);

// Returns the model with which a fit of `problem` begins. Named parameters that
// the baseline also has get its values, clamped to their bounds. All others
// have the problem's initial values.
IdentifiedModel BeginFromBaseline(const Baseline& baseline,
                                  const IdentificationProblem& problem);

// Gets values and covariance of the parameters `names` from a fit of
// `dynamics`. Groups have values as in Baseline::groups. Returns false, with
// *error, if a parameter has no covariance.
[[nodiscard]] bool GroupsOf(const StructuralDynamics& dynamics,
                            const FitSummary& summary,
                            const std::vector<std::string>& names,
                            GroupState* state, std::string* error);

// Returns the amounts that turn the alphas of these groups into values as in
// Baseline::groups, one per name. 0 if there is no group of this name.
Vector AlreadyPresent(const StructuralDynamics& dynamics,
                      const std::vector<std::string>& names);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_BASELINE_H_
