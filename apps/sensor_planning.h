// Where to put sensors, by a case: pinode_check --plan.

#ifndef PINODE_APPS_SENSOR_PLANNING_H_
#define PINODE_APPS_SENSOR_PLANNING_H_

#include <string>

namespace pinode {

struct PlannedSensors {
  std::string text;
  // Whether the planned sensors determine every named parameter.
  bool all_determined = false;
};

// Reads the case and all it names, plans, and says so. False, with one line in
// *error, where something is wrong with the case.
[[nodiscard]] bool PlanForCase(const std::string& case_path, int num_sensors,
                               PlannedSensors* planned, std::string* error);

}  // namespace pinode

#endif  // PINODE_APPS_SENSOR_PLANNING_H_
