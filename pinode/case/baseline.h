// Results of healthy records, to compare a new state with.

#ifndef PINODE_CASE_BASELINE_H_
#define PINODE_CASE_BASELINE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/case/case_file.h"
#include "pinode/damage/change.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/identification_problem.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

struct Baseline {
  std::string folder;
  // In the order of the names asked for, such that 1 + value is what the
  // structure has of the group's matrix, see GroupTerm::present.
  GroupState groups;
  // alpha of the same matrices in the new case is that much larger: not zero
  // where the new case is built on a model.toml, which holds what was found.
  Vector offsets;
  // All named parameters of the result, those that were fixed too.
  std::vector<std::string> parameter_names;
  Vector parameter_values;
};

// Reads the result folder of pinode_update for a healthy record of the
// structure of the case: result.json, covariance.csv and matrices. `names`: the
// groups whose change is asked for.
//
// Refused, with *error naming file and group: a folder that is not a result,
// one that is not usable, a group that it lacks or has fixed, one whose matrix
// differs from that of the case (another structure), and other units. Where the
// case renews its basis, M and K of the finite-element model are what has to be
// the same.
[[nodiscard]] bool ReadBaseline(const std::string& folder, const Case& c,
                                const std::vector<std::string>& names,
                                Baseline* baseline, std::string* error);

// What a fit of `problem` begins from: its own initial values, and those of the
// baseline for the named parameters that both have, kept inside their bounds.
// `groups`: those that `baseline` was read for.
IdentifiedModel BeginFromBaseline(const Baseline& baseline,
                                  const std::vector<std::string>& groups,
                                  const IdentificationProblem& problem);

// The free groups and other parameters `names` of a fit of `dynamics` with a
// covariance; groups as in Baseline.
GroupState GroupsOf(const StructuralDynamics& dynamics,
                    const IdentificationSummary& summary,
                    const std::vector<std::string>& names);

// What has to be added to each group's alpha for a value as in Baseline; 0
// where there is no group of that name.
Vector AlreadyPresent(const StructuralDynamics& dynamics,
                      const std::vector<std::string>& names);

}  // namespace pinode

#endif  // PINODE_CASE_BASELINE_H_
