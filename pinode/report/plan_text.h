// Text of a sensor plan for a terminal.

#ifndef PINODE_REPORT_PLAN_TEXT_H_
#define PINODE_REPORT_PLAN_TEXT_H_

#include <string>
#include <vector>

#include "pinode/problem/identification_problem.h"
#include "pinode/study/sensors/sensor_information.h"
#include "pinode/study/sensors/sensor_plan.h"

namespace pinode {

// Returns the sensors in the order of their gain with their assumed noise, the
// deviations (95 %) before and after, and the unknowns that stay undetermined.
std::string PlanText(const IdentificationProblem& problem,
                     const std::vector<CandidateSensor>& candidates,
                     const SensorPlanOptions& options, const SensorPlan& plan);

// Returns one line for each duration.
std::string DurationsText(const IdentificationProblem& problem,
                          const std::vector<PlannedDuration>& durations);

// Returns one line for each, the best by the criterion first; sensors in the
// order of `candidates` there.
std::string ExcitationsText(const SensorPlanOptions& options,
                            std::vector<PlannedExcitation> excitations);

}  // namespace pinode

#endif  // PINODE_REPORT_PLAN_TEXT_H_
