// Result folder of pinode_check --plan, written on request.

#ifndef PINODE_CASE_RESULTS_PLAN_FILES_H_
#define PINODE_CASE_RESULTS_PLAN_FILES_H_

#include <string>
#include <vector>

#include "pinode/case/sections/case_file.h"
#include "pinode/study/sensors/sensor_plan.h"

namespace pinode {

// Plan of sensors, with the durations and excitations that the case asks for.
struct CasePlan {
  SensorPlan plan;
  std::vector<PlannedDuration> durations;      // in the order of the case
  std::vector<PlannedExcitation> excitations;  // likewise
};

// {"schema": "pinode-plan-1", "case", "title", "all_determined",
//  "criterion": "determinant" or "worst_deviation", "targets": [...],
//  "sensors": [{"name", "quantity", "unit", "sigma", "typical", "worst",
//               "worst_of"}],
//  "one_more": as one of the sensors, or null,
//  "own": {"typical", "worst", "worst_of"} or null,
//  "deviations": [{"name", "unit", "initial", "own", "planned", "all"}],
//  "undetermined": [...], "undetermined_by_own": [...],
//  "durations": [{"duration", "typical", "worst", "worst_of"}],
//  "excitations": [{"dof", "typical", "worst", "worst_of", "sensors": [...]}]}
// Unknown numbers are null.
std::string PlanAsJson(const Case& c, const CasePlan& planned);

// Writes to `folder`: plan.json, sensors.csv and deviations.csv, and, if the
// case asks for them, durations.csv and excitations.csv.
[[nodiscard]] bool WritePlanFiles(const Case& c, const CasePlan& planned,
                                  const std::string& folder,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_PLAN_FILES_H_
