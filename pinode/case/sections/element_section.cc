#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/sections/terms_section.h"
#include "pinode/case/text/parameter_keys.h"
#include "pinode/dynamics/element_library.h"
#include "pinode/dynamics/elements.h"

namespace pinode {
namespace {

// Reads one entry of `parameters`: a bare number (fixed), or a table.
bool ReadElementParameter(const TomlTable& table, const TomlTable& parameters,
                          const ElementParameterInfo& info,
                          const std::string& element, const UnitSystem& units,
                          Parameter* parameter) {
  parameter->name = element + "." + info.name;
  parameter->unit = PowersUnitName(info.force_power, info.length_power,
                                   info.time_power, units);
  parameter->lower = info.lower;
  parameter->upper = info.upper;
  parameter->value = info.default_value;
  const TomlValue* value = parameters.Find(info.name);
  const bool has_initial =
      value != nullptr &&
      (value->IsNumber() || value->Find("initial") || value->Find("tie"));
  if (!has_initial && std::isnan(info.default_value)) {
    return (value != nullptr ? parameters : table)
        .Fail(value != nullptr ? info.name : "name",
              "parameter '" + info.name +
                  "' needs a value, expected parameters." + info.name +
                  " = {initial = ...}, or a number that stays fixed");
  }
  if (value == nullptr || value->IsNumber()) {
    parameter->free = false;
    parameter->value = parameters.Number(info.name, info.default_value);
    parameter->prior_mean = parameter->value;
    if (!table.errors()->ok()) return false;
    if (parameter->value < info.lower || parameter->value > info.upper) {
      return parameters.Fail(info.name, "parameter '" + info.name + "' is " +
                                            FormatNumber(parameter->value) +
                                            ", expected a value within [" +
                                            FormatNumber(info.lower) + ", " +
                                            FormatNumber(info.upper) + "]");
    }
    return true;
  }
  const TomlTable keys =
      parameters.Table(info.name, table.name() + ", parameter " + info.name);
  return table.errors()->ok() && keys.AllowKeys() &&
         ReadParameterKeys(keys, 1.0, parameter);
}

// Reads `optional`: one of the amplitudes of the force must be free.
bool AddElementCandidate(const TomlTable& table, const LawTerm& term,
                         const std::vector<ElementParameterInfo>& infos,
                         const TermsContext& context) {
  ModelCandidate candidate = ElementCandidate(term, infos);
  for (const Parameter& parameter : term.parameters.parameters) {
    if (parameter.free &&
        std::count(candidate.amplitudes.begin(), candidate.amplitudes.end(),
                   parameter.name) > 0) {
      context.candidates->push_back(std::move(candidate));
      return true;
    }
  }
  return table.Fail("optional", "none of " + Join(candidate.amplitudes, ", ") +
                                    " is free, expected at least one free "
                                    "parameter to decide whether it acts");
}

// Reads the law and its parameters: of a known type, or of the shared library
// `file`.
bool ReadLaw(const TomlTable& table, LawTerm* term,
             std::vector<ElementParameterInfo>* infos) {
  term->type = table.RequiredString("type");
  if (!table.errors()->ok()) return false;
  std::string error;
  if (!table.Has("file")) {
    term->law = CreateElement(term->type, &error);
    if (term->law == nullptr) return table.Fail("type", error);
    *infos = ElementParameters(term->type);
    return true;
  }
  ElementLibrary library;
  const std::string path = table.String("file");
  if (!table.errors()->ok()) return false;
  if (!LoadElementLibrary(ResolvePath(table, path), &library, &error)) {
    return table.Fail("file", error);
  }
  const ElementLibrary::Element* element = library.Find(term->type, &error);
  if (element == nullptr) return table.Fail("type", path + ": " + error);
  term->law = element->create();
  *infos = element->parameters;
  term->identity = term->type + " " + library.fingerprint();
  term->type = "user";
  return true;
}

bool ReadElement(const StructuralModel& model, const TermsContext& context,
                 TomlTable* table, StructuralDynamics* dynamics) {
  LawTerm term;
  term.name = table->RequiredString("name");
  if (!table->errors()->ok()) return false;
  table->set_name("element '" + term.name + "'");
  std::vector<ElementParameterInfo> infos;
  int from = -1;
  int to = -1;
  if (!CheckName(*table, "name", term.name) ||
      !ReadLaw(*table, &term, &infos) ||
      !table->RequireKey("between", "two ends") ||
      !ReadBetween(model, *table, &from, &to)) {
    return false;
  }
  term.features = {Feature::Deformation(from, to),
                   Feature::DeformationRate(from, to)};
  // The force resists d = x[to] - x[from] at both ends.
  term.outputs = term.features[0].Selector(model.num_dofs()).transpose();
  term.parameters.name = term.name;

  const TomlTable parameters =
      table->Table("parameters", table->name() + ", parameters");
  std::vector<std::string> known;
  for (const ElementParameterInfo& info : infos) known.push_back(info.name);
  if (!table->errors()->ok() || !parameters.AllowKeys(known)) return false;
  for (const ElementParameterInfo& info : infos) {
    Parameter parameter;
    if (!ReadElementParameter(*table, parameters, info, term.name,
                              *context.units, &parameter)) {
      return false;
    }
    term.parameters.parameters.push_back(parameter);
  }
  if (table->Boolean("optional", false) &&
      !AddElementCandidate(*table, term, infos, context)) {
    return false;
  }
  std::string error;
  return dynamics->AddLaw(std::move(term), &error) ||
         table->Fail("name", error);
}

}  // namespace

bool ReadElements(const TomlTable& root, const TermsContext& context,
                  StructuralDynamics* dynamics) {
  std::set<std::string> seen;
  for (TomlTable& table : root.Tables("element")) {
    if (!table.AllowKeys()) {
      return false;
    }
    if (!seen.insert(table.RequiredString("name")).second) {
      return table.Fail("name",
                        "this name is used twice, expected different names");
    }
    if (!ReadElement(context.model->model, context, &table, dynamics)) {
      return false;
    }
  }
  return root.errors()->ok();
}

}  // namespace pinode
