// Where to put sensors, by a case: pinode_check --plan.

#ifndef PINODE_APPS_SENSOR_PLANNING_H_
#define PINODE_APPS_SENSOR_PLANNING_H_

#include <string>

#include "pinode/case/results/plan_files.h"
#include "pinode/case/sections/case_file.h"

namespace pinode {

// Reads the case and all it names, and plans: sensors, and what the case asks
// of durations and of places for the force. False, with one line in *error,
// where something is wrong with the case.
[[nodiscard]] bool PlanForCase(const std::string& case_path, int num_sensors,
                               Case* c, CasePlan* planned, std::string* error);

// What a person is told of it.
std::string CasePlanText(const Case& c, const CasePlan& planned);

}  // namespace pinode

#endif  // PINODE_APPS_SENSOR_PLANNING_H_
