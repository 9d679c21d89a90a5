#include "apps/sensor_planning.h"

#include <utility>
#include <vector>

#include "pinode/case/case_file.h"
#include "pinode/report/plan_text.h"
#include "pinode/study/sensor_plan.h"

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

// Of each place at which the force could act, the sensors that suit it.
bool AddExcitations(const Case& own, int num_sensors, std::string* text,
                    std::string* error) {
  if (own.plan.excite.empty()) return true;
  std::vector<PlannedExcitation> excitations;
  for (const std::string& dof : own.plan.excite) {
    Case moved;
    PlannedExcitation planned;
    planned.dof = dof;
    if (!ReadCaseForPlanning(own.path, dof, &moved, error) ||
        !Plan(&moved, num_sensors, &planned.plan, error)) {
      return false;
    }
    excitations.push_back(std::move(planned));
  }
  *text += "\nWith the first force of each record alone, and sensors for it\n" +
           ExcitationsText(own.plan.options, std::move(excitations));
  return true;
}

}  // namespace

bool PlanForCase(const std::string& case_path, int num_sensors,
                 PlannedSensors* planned, std::string* error) {
  Case c;
  SensorPlan plan;
  if (!ReadCaseForPlanning(case_path, "", &c, error) ||
      !Plan(&c, num_sensors, &plan, error)) {
    return false;
  }
  std::string& text = planned->text;
  if (!c.problem.description.title.empty()) {
    text += c.problem.description.title + "\n\n";
  }
  text += PlanText(c.problem, c.plan.candidates, c.plan.options, plan);
  if (!c.plan.durations.empty()) {
    std::vector<PlannedDuration> durations;
    if (!PlanDurations(c.problem, c.options, c.plan.own, c.plan.candidates,
                       c.plan.options, plan, c.plan.durations, &durations,
                       error)) {
      *error = c.path + ": " + *error;
      return false;
    }
    text +=
        "\nWith the planned sensors\n" + DurationsText(c.problem, durations);
  }
  planned->all_determined = plan.undetermined_by_plan.empty();
  return AddExcitations(c, num_sensors, &text, error);
}

}  // namespace pinode
