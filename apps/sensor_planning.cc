#include "apps/sensor_planning.h"

#include <utility>
#include <vector>

#include "pinode/report/plan_text.h"
#include "pinode/study/sensors/sensor_plan.h"

namespace pinode {
namespace {

bool Plan(Case* c, int num_sensors, SensorPlan* plan, std::string* error) {
  c->plan.options.num_sensors = num_sensors;
  if (PlanSensors(c->problem, c->options, c->plan.own, c->plan.candidates,
                  c->plan.options, plan, error)) {
    return true;
  }
  *error = c->path + ": " + *error;
  return false;
}

// Plans the best sensors for each possible place of the force.
bool PlanExcitations(const Case& own, int num_sensors,
                     std::vector<PlannedExcitation>* excitations,
                     std::string* error) {
  for (const std::string& dof : own.plan.excite) {
    Case moved;
    PlannedExcitation planned;
    planned.dof = dof;
    if (!ReadCaseForPlanning(own.path, dof, &moved, error) ||
        !Plan(&moved, num_sensors, &planned.plan, error)) {
      return false;
    }
    excitations->push_back(std::move(planned));
  }
  return true;
}

}  // namespace

bool PlanForCase(const std::string& case_path, int num_sensors, Case* c,
                 CasePlan* planned, std::string* error) {
  if (!ReadCaseForPlanning(case_path, "", c, error) ||
      !Plan(c, num_sensors, &planned->plan, error)) {
    return false;
  }
  if (!c->plan.durations.empty() &&
      !PlanDurations(c->problem, c->options, c->plan.own, c->plan.candidates,
                     c->plan.options, planned->plan, c->plan.durations,
                     &planned->durations, error)) {
    *error = c->path + ": " + *error;
    return false;
  }
  return PlanExcitations(*c, num_sensors, &planned->excitations, error);
}

std::string CasePlanText(const Case& c, const CasePlan& planned) {
  std::string text;
  if (!c.problem.description.title.empty()) {
    text += c.problem.description.title + "\n\n";
  }
  text += PlanText(c.problem, c.plan.candidates, c.plan.options, planned.plan);
  if (!planned.durations.empty()) {
    text += "\nWith the planned sensors\n" +
            DurationsText(c.problem, planned.durations);
  }
  if (!planned.excitations.empty()) {
    text += "\nWith only the first force of each record, and sensors for it\n" +
            ExcitationsText(c.plan.options, planned.excitations);
  }
  return text;
}

}  // namespace pinode
