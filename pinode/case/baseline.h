// Results of healthy records, to compare a new state with.

#ifndef PINODE_CASE_BASELINE_H_
#define PINODE_CASE_BASELINE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/damage/change.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/identification_problem.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

struct Baseline {
  std::string folder;
  // In the order of the names asked for: alpha as the baseline's own case has
  // it, so that 1 + alpha is what the group has of its nominal stiffness.
  GroupState groups;
  // alpha of the same matrices in the new case is that much larger: not zero
  // where the new case is built on a model.toml, which holds what was found.
  Vector offsets;
  // All named parameters of the result, those that were fixed too.
  std::vector<std::string> parameter_names;
  Vector parameter_values;
};

// Reads the result folder of pinode_update for a healthy record of the
// structure of `dynamics`: result.json, covariance.csv and the groups'
// matrices. `names`: the groups whose change is asked for.
//
// Refused, with *error naming file and group: a folder that is not a result,
// one that is not usable, a group that it lacks or has fixed, one whose matrix
// differs from that of `dynamics` (another structure), and other units.
[[nodiscard]] bool ReadBaseline(const std::string& folder,
                                const StructuralDynamics& dynamics,
                                const std::vector<std::string>& names,
                                Baseline* baseline, std::string* error);

// What a fit of `problem` begins from: its own initial values, and those of the
// baseline for the named parameters that both have, kept inside their bounds.
// `groups`: those that `baseline` was read for.
IdentifiedModel BeginFromBaseline(const Baseline& baseline,
                                  const std::vector<std::string>& groups,
                                  const IdentificationProblem& problem);

// The free groups `names` of a fit with a covariance.
GroupState GroupsOf(const IdentificationSummary& summary,
                    const std::vector<std::string>& names);

}  // namespace pinode

#endif  // PINODE_CASE_BASELINE_H_
