// Fits of baseline records, to compare a new state with.

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

// Baseline records with their model, which distinguish changes of other kinds
// than those of groups.
struct HealthyFit {
  IdentificationProblem problem;
  IdentificationOptions options;
  // Results of a fit of `problem`. Without parameters if it must be fitted
  // first, from its own values.
  IdentificationSummary summary;
  IdentifiedModel model;

  bool IsFitted() const { return model.parameters.size() > 0; }
};

// Alternatives to the values of a result with care.
struct Doubts {
  // How far named parameters may be off: as far as the intervals of the
  // likeliest explanations reach and, where motion is unexplained, the result's
  // own intervals, which are as wide as what the model may lack.
  std::vector<ExplainedValue> reach = {};
  // The likeliest explanation, if it leaves nothing but noise.
  std::optional<Explanation> whole = std::nullopt;
};

struct Baseline {
  // Name in messages and reports, such as the folder it was read from.
  std::string name;
  // Free groups that follow no covariate (FreeGroups), and their values such
  // that 1 + value is the structure's multiple of the group's matrix, see
  // GroupTerm::present.
  std::vector<std::string> group_names;
  GroupState groups;
  // Free parameters by which groups follow covariates. `with_followers` has
  // groups and these together, in this order.
  std::vector<std::string> followers;
  std::vector<std::string> following;  // FollowingText of each
  // Directions that the records do not determine, as in IdentificationSummary.
  std::vector<std::string> undetermined;
  GroupState with_followers;
  // Offset of alpha of the same matrices in the new problem. It is not zero if
  // the new problem's matrices include the identified changes. Empty: offsets
  // follow from GroupTerm::present of the new problem.
  Vector offsets;
  // All named parameters of the fit, including fixed ones.
  std::vector<std::string> parameter_names;
  Vector parameter_values;

  Doubts doubts = {};  // DoubtsOf the result

  // Fit of the baseline. Null if only the groups' values are known, with the
  // reason as half a sentence in `why_no_fit`.
  std::shared_ptr<const HealthyFit> fit;
  std::string why_no_fit = "the baseline has no records";
};

// Returns the names of the groups to be compared: the free ones that follow no
// covariate.
std::vector<std::string> FreeGroups(const StructuralDynamics& dynamics);

// Returns the parameters by which groups follow covariates
// (CovariateParameters), those that are free or those that are not.
std::vector<std::string> Followers(const StructuralDynamics& dynamics,
                                   bool free);

// Returns how a group follows a covariate: "temperature from 20", or
// "temperature from 20 by knots at -10, 0, 20". Parameters with different texts
// are different parameters.
std::string FollowingText(const std::string& covariate, double reference,
                          const std::vector<double>& knots);
// Returns the texts by the names of all such parameters of `dynamics`.
std::map<std::string, std::string> FollowingTexts(
    const StructuralDynamics& dynamics);

// True if motion is unexplained.
bool MissesMotion(const Verdict& verdict);

// Returns nothing for results that are not with care.
Doubts DoubtsOf(const IdentificationSummary& summary);

// Makes a baseline from a usable fit of baseline records with a covariance.
// Returns false, with *error, if the fit is not usable, or if no group is free.
[[nodiscard]] bool BaselineFrom(const std::string& name,
                                const IdentificationProblem& problem,
                                const IdentificationSummary& summary,
                                const IdentifiedModel& model,
                                Baseline* baseline, std::string* error);

// Returns false, with *error, if two baselines are identical to the last bit:
// the scatter between baselines would be underestimated.
[[nodiscard]] bool AreDifferentResults(const std::vector<Baseline>& baselines,
                                       std::string* error);

// Returns false, with *error, if a baseline cannot be compared with fits of
// `dynamics`: other groups, a value that is not finite, a group that follows a
// covariate in another way, or if two are
// identical (AreDifferentResults).
[[nodiscard]] bool AreBaselinesOf(const StructuralDynamics& dynamics,
                                  const std::vector<Baseline>& baselines,
                                  std::string* error);

// Returns the model from which a fit of `problem` begins: its own initial
// values, and those of the baseline for the named parameters that both have,
// clamped to their bounds.
IdentifiedModel BeginFromBaseline(const Baseline& baseline,
                                  const IdentificationProblem& problem);

// Takes the free groups and other parameters `names` from a fit of `dynamics`,
// with groups as in Baseline. Returns false, with *error, if one of them has no
// covariance.
[[nodiscard]] bool GroupsOf(const StructuralDynamics& dynamics,
                            const FitSummary& summary,
                            const std::vector<std::string>& names,
                            GroupState* state, std::string* error);

// Returns the amount to add to each group's alpha for a value as in Baseline; 0
// if there is no group of that name.
Vector AlreadyPresent(const StructuralDynamics& dynamics,
                      const std::vector<std::string>& names);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_BASELINE_H_
