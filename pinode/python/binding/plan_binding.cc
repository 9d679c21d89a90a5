#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/results/check_files.h"
#include "pinode/case/results/matlab_results.h"
#include "pinode/case/results/plan_files.h"
#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/plan_section.h"
#include "pinode/problem/problem_description.h"
#include "pinode/python/binding/convert.h"
#include "pinode/python/binding/fit.h"
#include "pinode/python/binding/watch.h"
#include "pinode/report/plan_text.h"
#include "pinode/study/sensors/sensor_plan.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

py::dict Reached(const SensorPlan::Step& step) {
  py::dict entry;
  entry["typical"] = step.typical;
  entry["worst"] = step.worst;
  entry["worst_of"] = step.worst_name;
  return entry;
}

// Returns the result with one more sensor, and its name; None: there is none.
py::object Sensor(const Case& c, const SensorPlan& plan,
                  const SensorPlan::Step& step) {
  if (step.candidate < 0) return py::none();
  const auto i = static_cast<size_t>(step.candidate);
  const Observation& observation = c.plan.candidates[i].observation;
  const SensorInformation& information = plan.information.candidates[i];
  py::dict entry = Reached(step);
  entry["name"] = observation.name;
  entry["quantity"] = QuantityName(observation.quantity);
  entry["sigma"] = information.sigma;
  entry["rms"] = information.rms;
  entry["unit"] =
      UnitName(DimensionOf(observation.quantity), c.problem.description.units);
  return entry;
}

py::dict Deviations(const SensorPlan& plan) {
  const bool has_own = !plan.information.own.empty();
  py::dict deviations;
  for (size_t i = 0; i < plan.by_plan.size(); ++i) {
    const ExpectedDeviation& planned = plan.by_plan[i];
    py::dict entry;
    entry["unit"] = planned.unit;
    entry["initial"] = planned.initial;
    entry["own"] =
        has_own ? py::object(py::float_(plan.by_own[i].sigma)) : py::none();
    entry["planned"] = planned.sigma;
    entry["all"] = plan.by_all[i].sigma;
    deviations[py::str(planned.name)] = std::move(entry);
  }
  return deviations;
}

// The case, read again for its [plan], and the plan.
struct Plan {
  Case c;
  CasePlan planned;
  bool ok = false;
  std::string error;
};

// Makes a plan. With `force_at` not empty the first force of each record acts
// at that DOF, and no other load does.
void MakePlan(const Case& given, int num_sensors, const std::string& force_at,
              Plan* plan) {
  TomlValue tree = *given.source;
  Case& c = plan->c;
  CasePlan& planned = plan->planned;
  std::string* error = &plan->error;
  if (!MoveForces(given.path, force_at, &tree, error) ||
      !ReadCaseTree(tree, given.path, given.data, CasePurpose::kPlanning, &c,
                    error)) {
    return;
  }
  c.plan.options.num_sensors = num_sensors;
  plan->ok = PlanSensors(c.problem, c.options, c.plan.own, c.plan.candidates,
                         c.plan.options, &planned.plan, error) &&
             (c.plan.durations.empty() ||
              PlanDurations(c.problem, c.options, c.plan.own, c.plan.candidates,
                            c.plan.options, planned.plan, c.plan.durations,
                            &planned.durations, error));
}

// Writes a folder as pinode_check --plan does, without excitations.
bool WritePlan(const Plan& made, const std::string& output, bool overwrite,
               bool mat, std::string* error) {
  ResultFolder folder;
  return MayGiveWayToCheck(output, error) &&
         folder.Open(output, overwrite, /*resume=*/false, error) &&
         WritePlanFiles(made.c, made.planned, folder.working_path(), error) &&
         (!mat || WriteMatlabResults(folder.working_path(), error)) &&
         folder.Commit(error);
}

py::dict PlanCase(const std::shared_ptr<const CaseHandle>& handle,
                  int num_sensors, const std::string& force_at,
                  const std::string& output, bool overwrite, bool mat) {
  if (num_sensors < 1) {
    throw Error("num_sensors is " + std::to_string(num_sensors) +
                ", expected at least 1");
  }
  const auto made = std::make_shared<Plan>();
  RunInterruptibly([handle, made, num_sensors, force_at] {
    MakePlan(handle->c, num_sensors, force_at, made.get());
  });
  Require(made->ok, made->error);
  if (!output.empty()) {
    std::string error;
    bool ok = false;
    {
      py::gil_scoped_release release;
      ok = WritePlan(*made, output, overwrite, mat, &error);
    }
    Require(ok, error);
  }
  const Case& c = made->c;
  const SensorPlan& plan = made->planned.plan;
  const std::vector<PlannedDuration>& durations = made->planned.durations;
  py::dict result;
  py::list sensors, cut;
  for (const SensorPlan::Step& step : plan.steps) {
    sensors.append(Sensor(c, plan, step));
  }
  for (const PlannedDuration& duration : durations) {
    py::dict entry = Reached(duration.reached);
    entry["duration"] = duration.duration;
    cut.append(std::move(entry));
  }
  result["targets"] = plan.targets;
  result["sensors"] = std::move(sensors);
  result["one_more"] = Sensor(c, plan, plan.next);
  result["own"] =
      plan.information.own.empty() ? py::object(py::none()) : Reached(plan.own);
  result["deviations"] = Deviations(plan);
  result["undetermined"] = plan.undetermined_by_plan;
  result["undetermined_by_own"] = plan.undetermined_by_own;
  result["durations"] = std::move(cut);
  result["excite"] = c.plan.excite;
  result["text"] =
      PlanText(c.problem, c.plan.candidates, c.plan.options, plan) +
      (durations.empty() ? ""
                         : "\nWith the planned sensors\n" +
                               DurationsText(c.problem, durations));
  return result;
}

}  // namespace

void BindPlan(py::module_* module) {
  module->def("plan_sensors", &PlanCase, py::arg("case"),
              py::arg("num_sensors"), py::arg("force_at") = "",
              py::arg("output") = "", py::arg("overwrite") = false,
              py::arg("mat") = false);
}

}  // namespace pinode::python
