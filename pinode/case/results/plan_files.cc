#include "pinode/case/results/plan_files.h"

#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/units.h"
#include "pinode/case/text/json_table.h"
#include "pinode/problem/problem_description.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

Json Reached(const SensorPlan::Step& step) {
  return {{"typical", step.typical},
          {"worst", step.worst},
          {"worst_of", step.worst_name}};
}

Json Sensor(const Case& c, const SensorPlan& plan,
            const SensorPlan::Step& step) {
  const auto i = static_cast<size_t>(step.candidate);
  const Observation& observation = c.plan.candidates[i].observation;
  Json sensor;
  sensor["name"] = observation.name;
  sensor["quantity"] = QuantityName(observation.quantity);
  sensor["unit"] =
      UnitName(DimensionOf(observation.quantity), c.problem.description.units);
  sensor["sigma"] = plan.information.candidates[i].sigma;
  sensor.update(Reached(step));
  return sensor;
}

std::vector<std::string> SensorNames(const SensorPlan& plan) {
  std::vector<std::string> names;
  for (const SensorPlan::Step& step : plan.steps) {
    names.push_back(
        plan.information.candidates[static_cast<size_t>(step.candidate)].name);
  }
  return names;
}

Json Deviations(const SensorPlan& plan) {
  Json deviations = Json::array();
  for (size_t i = 0; i < plan.by_plan.size(); ++i) {
    const ExpectedDeviation& planned = plan.by_plan[i];
    deviations.push_back(
        {{"name", planned.name},
         {"unit", planned.unit},
         {"initial", planned.initial},
         {"own", plan.information.own.empty() ? Json(nullptr)
                                              : Json(plan.by_own[i].sigma)},
         {"planned", planned.sigma},
         {"all", plan.by_all[i].sigma}});
  }
  return deviations;
}

Json Durations(const CasePlan& planned) {
  Json durations = Json::array();
  for (const PlannedDuration& duration : planned.durations) {
    Json entry;
    entry["duration"] = duration.duration;
    entry.update(Reached(duration.reached));
    durations.push_back(std::move(entry));
  }
  return durations;
}

Json Excitations(const CasePlan& planned) {
  Json excitations = Json::array();
  for (const PlannedExcitation& excitation : planned.excitations) {
    Json entry;
    entry["dof"] = excitation.dof;
    entry.update(Reached(excitation.plan.steps.back()));
    entry["sensors"] = SensorNames(excitation.plan);
    excitations.push_back(std::move(entry));
  }
  return excitations;
}

Json Plan(const Case& c, const CasePlan& planned) {
  const SensorPlan& plan = planned.plan;
  Json json;
  json["schema"] = "pinode-plan-1";
  json["case"] = c.path;
  json["title"] = c.problem.description.title;
  json["all_determined"] = plan.undetermined_by_plan.empty();
  json["criterion"] =
      c.plan.options.criterion == SensorPlanOptions::Criterion::kDeterminant
          ? "determinant"
          : "worst_deviation";
  json["targets"] = plan.targets;
  json["sensors"] = Json::array();
  for (const SensorPlan::Step& step : plan.steps) {
    json["sensors"].push_back(Sensor(c, plan, step));
  }
  json["one_more"] =
      plan.next.candidate < 0 ? Json(nullptr) : Sensor(c, plan, plan.next);
  json["own"] =
      plan.information.own.empty() ? Json(nullptr) : Reached(plan.own);
  json["deviations"] = Deviations(plan);
  json["undetermined"] = plan.undetermined_by_plan;
  json["undetermined_by_own"] = plan.undetermined_by_own;
  json["durations"] = Durations(planned);
  json["excitations"] = Excitations(planned);
  return json;
}

std::string PlanJsonText(const Json& json) {
  // Names that are not UTF-8 must not end the program.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string PlanAsJson(const Case& c, const CasePlan& planned) {
  return PlanJsonText(Plan(c, planned));
}

bool WritePlanFiles(const Case& c, const CasePlan& planned,
                    const std::string& folder, std::string* error) {
  const Json json = Plan(c, planned);
  if (!WriteFileAtomically(folder + "/plan.json", PlanJsonText(json), error)) {
    return false;
  }
  for (const char* name :
       {"sensors", "deviations", "durations", "excitations"}) {
    if (!json[name].empty() &&
        !WriteFileAtomically(folder + "/" + name + ".csv",
                             TableOfEntries(json[name]), error)) {
      return false;
    }
  }
  return true;
}

}  // namespace pinode
