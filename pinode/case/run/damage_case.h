// Changes in the structure of a case relative to baselines.

#ifndef PINODE_CASE_RUN_DAMAGE_CASE_H_
#define PINODE_CASE_RUN_DAMAGE_CASE_H_

#include <string>
#include <vector>

#include "pinode/case/run/fit_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/damage/change.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/damage/baseline.h"
#include "pinode/study/damage/damage_analysis.h"

namespace pinode {

// A healthy structure and its new state are the same model: candidates that no
// baseline has are left out of *c, the others stay, and nothing is chosen; the
// basis of a reduction is that of the first baseline, where the case renews it.
// *begin_from is what the fit of the new state begins with. False, with *error,
// where there is no baseline, or the case cannot be had so.
[[nodiscard]] bool PrepareForBaselines(const std::vector<Baseline>& baselines,
                                       Case* c, IdentifiedModel* begin_from,
                                       std::string* error);

struct JudgedChange {
  bool judged = false;
  bool interrupted = false;
  // Reason why a usable result was not judged.
  std::string why_not;
  DamageResult result;
};

// Compares the result of the new state with the baselines. *c then has the
// candidates that were let in. A result that is not usable is not judged.
JudgedChange JudgeChange(const IdentificationSummary& summary,
                         const IdentifiedModel& model,
                         const std::vector<Baseline>& baselines,
                         const ChangeOptions& change,
                         IdentificationWatch* watch, Case* c);

}  // namespace pinode

#endif  // PINODE_CASE_RUN_DAMAGE_CASE_H_
