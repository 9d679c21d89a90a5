// From healthy results and a fit of new records to what has changed.

#ifndef PINODE_CASE_DAMAGE_ANALYSIS_H_
#define PINODE_CASE_DAMAGE_ANALYSIS_H_

#include <string>
#include <vector>

#include "pinode/case/baseline.h"
#include "pinode/case/case_file.h"
#include "pinode/case/grown_case.h"
#include "pinode/damage/change.h"
#include "pinode/damage/verdict.h"
#include "pinode/estimate/identification_summary.h"

namespace pinode {

// What pinode_damage has found.
struct DamageResult {
  std::vector<std::string> baselines;  // folders
  ChangeOptions options;
  // The free groups of the case, then other kinds of change that were found.
  std::vector<ChangeSubject> subjects;
  ChangeEstimate estimate;
  Judgement judgement;
  // Subjects that masses or nonlinear forces were looked for in.
  std::vector<std::string> places;
  // One sentence each, such as why kinds of change were not told apart.
  std::vector<std::string> remarks;

  // The fit that all this is from: that of the case, or, where other kinds of
  // change were found, of the case with them as further unknowns.
  Case fitted;
  IdentificationSummary summary;
  IdentifiedModel model;
};

// Names of the groups whose change is asked for: the free ones that follow
// nothing.
std::vector<std::string> FreeGroups(const StructuralDynamics& dynamics);

// `baselines` were read for FreeGroups; `summary` and `model` are a usable fit
// of c with a covariance.
//
// Four fifths of the false-alarm rate are for changes of the groups alone. The
// rest is for masses and nonlinear forces at the places of c.damage: healthy
// records and new ones are each linearised at their fit with all of these as
// further unknowns, and where one of them is found in place of, or beside,
// groups, the new records are fitted again with it. For that the healthy
// records are fitted once more from the baselines' model.toml; where that
// cannot be done, a remark says so.
//
// False, with *error, where EstimateChange is.
[[nodiscard]] bool AnalyseDamage(const Case& c,
                                 const std::vector<Baseline>& baselines,
                                 const ChangeOptions& options,
                                 const IdentificationSummary& summary,
                                 const IdentifiedModel& model,
                                 const FitFunction& fit, DamageResult* result,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_DAMAGE_ANALYSIS_H_
