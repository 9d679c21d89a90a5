#include "pinode/report/plan_text.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/base/units.h"
#include "pinode/problem/problem_description.h"
#include "pinode/report/number_text.h"
#include "pinode/report/text_table.h"

namespace pinode {
namespace {

using Align = TextTable::Align;

std::string WithUnit(double value, const std::string& unit) {
  return ReadableNumber(value, 3) + (unit == "1" ? "" : " " + unit);
}

std::string NoiseUnit(const IdentificationProblem& problem,
                      const Observation& observation) {
  return UnitName(DimensionOf(observation.quantity), problem.description.units);
}

void AddStep(const std::string& name, const std::string& noise,
             const SensorPlan::Step& step, TextTable* table) {
  table->AddRow({name, noise, ReadableNumber(step.typical, 3),
                 ReadableNumber(step.worst, 3), step.worst_name});
}

std::string StepsText(const IdentificationProblem& problem,
                      const std::vector<CandidateSensor>& candidates,
                      const SensorPlanOptions& options,
                      const SensorPlan& plan) {
  TextTable table({{"Sensor", Align::kLeft},
                   {"noise", Align::kDecimal},
                   {"typical", Align::kDecimal},
                   {"worst", Align::kDecimal},
                   {"of", Align::kLeft}});
  if (options.keep_own) {
    AddStep("present sensors", "", plan.without, &table);
  }
  const auto add = [&](const SensorPlan::Step& step, const char* before) {
    const auto i = static_cast<size_t>(step.candidate);
    const Observation& observation = candidates[i].observation;
    AddStep(before + observation.name,
            WithUnit(plan.information.candidates[i].sigma,
                     NoiseUnit(problem, observation)),
            step, &table);
  };
  for (const SensorPlan::Step& step : plan.steps) add(step, "");
  if (plan.next.candidate >= 0) add(plan.next, "one more: ");
  if (!plan.information.own.empty()) {
    AddStep("the case's " + std::to_string(plan.information.own.size()), "",
            plan.own, &table);
  }
  return table.ToText();
}

std::string HalfWidth(double sigma) {
  return std::isfinite(sigma) ? ReadableNumber(1.96 * sigma, 3)
                              : "not determined";
}

std::string DeviationsText(const SensorPlan& plan) {
  const bool has_own = !plan.information.own.empty();
  std::vector<TextTable::Column> columns = {{"Unknown", Align::kLeft},
                                            {"initially", Align::kDecimal}};
  if (has_own) columns.push_back({"own sensors +-", Align::kDecimal});
  columns.push_back({"planned +-", Align::kDecimal});
  columns.push_back({"all places +-", Align::kDecimal});
  columns.push_back({"", Align::kLeft});
  TextTable table(std::move(columns));
  for (size_t j = 0; j < plan.by_plan.size(); ++j) {
    const ExpectedDeviation& planned = plan.by_plan[j];
    std::vector<std::string> row = {planned.name,
                                    ReadableNumber(planned.initial)};
    if (has_own) row.push_back(HalfWidth(plan.by_own[j].sigma));
    row.push_back(HalfWidth(planned.sigma));
    row.push_back(HalfWidth(plan.by_all[j].sigma));
    row.push_back(planned.unit == "1" ? "" : planned.unit);
    table.AddRow(std::move(row));
  }
  return table.ToText();
}

std::string InvisibleText(const std::string& whose,
                          const std::vector<std::string>& undetermined) {
  std::string text;
  for (const std::string& direction : undetermined) {
    text += whose + " do not determine: " + direction + ".\n";
  }
  return text;
}

}  // namespace

std::string PlanText(const IdentificationProblem& problem,
                     const std::vector<CandidateSensor>& candidates,
                     const SensorPlanOptions& options, const SensorPlan& plan) {
  const bool volume =
      options.criterion == SensorPlanOptions::Criterion::kDeterminant;
  std::string text =
      "Sensors: " + std::to_string(options.num_sensors) +
      (options.keep_own ? " more" : "") + " of " +
      Count(static_cast<int>(candidates.size()), "place") + ", " +
      (volume ? "largest determinant" : "smallest worst deviation") + " for " +
      Join(plan.targets, ", ") + "\n";
  text +=
      "Expected standard deviation as sensors are added, at the initial "
      "values; "
      "10 means unknown.\ntypical: geometric mean over the axes of the "
      "confidence region. worst: largest of one parameter.\n\n";
  text += StepsText(problem, candidates, options, plan);
  if (plan.num_exchanges > 0) {
    text += "  (" + Count(plan.num_exchanges, "exchange") +
            " after sensors were added one by one)\n";
  }
  text += "\nExpected uncertainty at the initial values (95 %)\n" +
          DeviationsText(plan) + "\n";
  if (!plan.information.own.empty()) {
    text += InvisibleText("The case's own sensors", plan.undetermined_by_own);
  }
  text += InvisibleText("The planned sensors", plan.undetermined_by_plan);
  if (plan.undetermined_by_plan.empty()) {
    text += "Every named parameter is determined by the planned sensors.\n";
  }
  return text;
}

std::string DurationsText(const IdentificationProblem& problem,
                          const std::vector<PlannedDuration>& durations) {
  TextTable table({{"Records cut to", Align::kDecimal},
                   {"typical", Align::kDecimal},
                   {"worst", Align::kDecimal},
                   {"of", Align::kLeft}});
  for (const PlannedDuration& cut : durations) {
    table.AddRow(
        {ReadableNumber(cut.duration) + " " + problem.description.units.time,
         ReadableNumber(cut.reached.typical, 3),
         ReadableNumber(cut.reached.worst, 3), cut.reached.worst_name});
  }
  return table.ToText();
}

std::string ExcitationsText(const SensorPlanOptions& options,
                            std::vector<PlannedExcitation> excitations) {
  const bool volume =
      options.criterion == SensorPlanOptions::Criterion::kDeterminant;
  const auto value = [volume](const PlannedExcitation& excitation) {
    const SensorPlan::Step& last = excitation.plan.steps.back();
    return volume ? last.typical : last.worst;
  };
  std::stable_sort(
      excitations.begin(), excitations.end(),
      [&value](const auto& a, const auto& b) { return value(a) < value(b); });
  TextTable table({{"Force at", Align::kLeft},
                   {"typical", Align::kDecimal},
                   {"worst", Align::kDecimal},
                   {"of", Align::kLeft},
                   {"sensors", Align::kLeft}});
  for (const PlannedExcitation& excitation : excitations) {
    std::vector<std::string> sensors;
    for (const SensorPlan::Step& step : excitation.plan.steps) {
      sensors.push_back(excitation.plan.information
                            .candidates[static_cast<size_t>(step.candidate)]
                            .name);
    }
    const SensorPlan::Step& last = excitation.plan.steps.back();
    table.AddRow({excitation.dof, ReadableNumber(last.typical, 3),
                  ReadableNumber(last.worst, 3), last.worst_name,
                  Join(sensors, " ")});
  }
  return table.ToText();
}

}  // namespace pinode
