// Sensor placement for a case: pinode_check --plan.

#ifndef PINODE_APPS_SENSOR_PLANNING_H_
#define PINODE_APPS_SENSOR_PLANNING_H_

#include <string>

#include "pinode/case/results/plan_files.h"
#include "pinode/case/sections/case_file.h"

namespace pinode {

// Reads the case and its files, and plans sensors, and the durations and places
// of the force that the case asks for. Returns false, with one line in *error,
// if the case has an error.
[[nodiscard]] bool PlanForCase(const std::string& case_path, int num_sensors,
                               Case* c, CasePlan* planned, std::string* error);

// Returns the plan as text for the console.
std::string CasePlanText(const Case& c, const CasePlan& planned);

}  // namespace pinode

#endif  // PINODE_APPS_SENSOR_PLANNING_H_
