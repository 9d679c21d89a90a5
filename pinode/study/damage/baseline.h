// Fits of healthy records, to compare a new state with.

#ifndef PINODE_STUDY_DAMAGE_BASELINE_H_
#define PINODE_STUDY_DAMAGE_BASELINE_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/damage/change.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Healthy records with their model, by which changes of other kinds than those
// of groups are told apart.
struct HealthyFit {
  IdentificationProblem problem;
  IdentificationOptions options;
  // Of `problem`; without parameters where it has to be fitted first, from its
  // own values.
  IdentificationSummary summary;
  IdentifiedModel model;

  bool IsFitted() const { return model.parameters.size() > 0; }
};

struct Baseline {
  // What messages and reports call it, such as the folder it was read from.
  std::string name;
  // The free groups that follow nothing (FreeGroups), and their values such
  // that 1 + value is what the structure has of the group's matrix, see
  // GroupTerm::present.
  std::vector<std::string> group_names;
  GroupState groups;
  // The free parameters by which groups follow covariates, and groups and these
  // together, in this order.
  std::vector<std::string> followers;
  std::vector<std::string> following;  // how each does, see FollowingText
  // Directions that its records leave open, as in IdentificationSummary.
  std::vector<std::string> undetermined;
  GroupState with_followers;
  // alpha of the same matrices in the new problem is that much larger: not zero
  // where its matrices hold what was found. Empty: as GroupTerm::present of the
  // new problem says.
  Vector offsets;
  // All named parameters of the fit, those that were fixed too.
  std::vector<std::string> parameter_names;
  Vector parameter_values;

  // Null where nothing but the groups' values is known, with the reason as half
  // a sentence in `why_no_fit`.
  std::shared_ptr<const HealthyFit> fit;
  std::string why_no_fit = "the baseline has no records";
};

// Names of the groups whose change is asked for: the free ones that follow
// nothing.
std::vector<std::string> FreeGroups(const StructuralDynamics& dynamics);

// The parameters by which groups follow covariates (CovariateParameters), by
// whether they are free.
std::vector<std::string> Followers(const StructuralDynamics& dynamics,
                                   bool free);

// How a group follows a covariate: "temperature from 20", or "temperature from
// 20 by knots at -10, 0, 20". What has another text is another parameter.
std::string FollowingText(const std::string& covariate, double reference,
                          const std::vector<double>& knots);
// The same by the names of all parameters by which groups of `dynamics` do.
std::map<std::string, std::string> FollowingTexts(
    const StructuralDynamics& dynamics);

// A baseline from a usable fit of healthy records with a covariance. False,
// with *error, where it is none, or where no group is free.
[[nodiscard]] bool BaselineFrom(const std::string& name,
                                const IdentificationProblem& problem,
                                const IdentificationSummary& summary,
                                const IdentifiedModel& model,
                                Baseline* baseline, std::string* error);

// False, with *error, where two baselines are the same to the last bit: what
// healthy records differ by would be taken for less than it is.
[[nodiscard]] bool AreDifferentResults(const std::vector<Baseline>& baselines,
                                       std::string* error);

// What a fit of `problem` begins from: its own initial values, and those of the
// baseline for the named parameters that both have, kept inside their bounds.
IdentifiedModel BeginFromBaseline(const Baseline& baseline,
                                  const IdentificationProblem& problem);

// The free groups and other parameters `names` of a fit of `dynamics`; groups
// as in Baseline. False, with *error, where one of them has no covariance.
[[nodiscard]] bool GroupsOf(const StructuralDynamics& dynamics,
                            const FitSummary& summary,
                            const std::vector<std::string>& names,
                            GroupState* state, std::string* error);

// What has to be added to each group's alpha for a value as in Baseline; 0
// where there is no group of that name.
Vector AlreadyPresent(const StructuralDynamics& dynamics,
                      const std::vector<std::string>& names);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_BASELINE_H_
