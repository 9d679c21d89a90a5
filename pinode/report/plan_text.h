// What a plan of sensors says, for a terminal.

#ifndef PINODE_REPORT_PLAN_TEXT_H_
#define PINODE_REPORT_PLAN_TEXT_H_

#include <string>
#include <vector>

#include "pinode/problem/identification_problem.h"
#include "pinode/study/sensors/sensor_information.h"
#include "pinode/study/sensors/sensor_plan.h"

namespace pinode {

// The sensors in the order of their gain with the noise that they were taken to
// have, the deviations (95 %) before and after, and what stays invisible.
std::string PlanText(const IdentificationProblem& problem,
                     const std::vector<CandidateSensor>& candidates,
                     const SensorPlanOptions& options, const SensorPlan& plan);

// One line for each duration.
std::string DurationsText(const IdentificationProblem& problem,
                          const std::vector<PlannedDuration>& durations);

// One line for each, the best by the criterion first; sensors in the order of
// `candidates` there.
std::string ExcitationsText(const SensorPlanOptions& options,
                            std::vector<PlannedExcitation> excitations);

}  // namespace pinode

#endif  // PINODE_REPORT_PLAN_TEXT_H_
