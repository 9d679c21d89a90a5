#include "pinode/case/case_file.h"

#include <set>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/discover_section.h"
#include "pinode/case/finite_element_section.h"
#include "pinode/case/library_section.h"
#include "pinode/case/modal_section.h"
#include "pinode/case/model_section.h"
#include "pinode/case/options_section.h"
#include "pinode/case/record_data.h"
#include "pinode/case/record_section.h"
#include "pinode/case/reference_curve_section.h"
#include "pinode/case/sensors_section.h"
#include "pinode/case/terms_section.h"
#include "pinode/case/toml_table.h"
#include "pinode/case/toml_value.h"
#include "pinode/case/unknown_force_section.h"

namespace pinode {
namespace {

// Names of parameters are unique over all terms and sensors.
bool CheckNames(const IdentificationProblem& problem, CaseErrors* errors) {
  std::set<std::string> seen;
  const auto add = [&](const ParameterBlock& block) {
    if (!block.named) return true;
    for (const Parameter& parameter : block.parameters) {
      if (seen.insert(parameter.name).second) continue;
      return errors->Fail(0, "two unknowns are named '" + parameter.name +
                                 "', expected different names of groups, "
                                 "elements and channels");
    }
    return true;
  };
  for (const ParameterBlock& block : problem.dynamics->blocks()) {
    if (!add(block)) return false;
  }
  return add(problem.sensors);
}

// What the model's modes are, where that is not all of the model.
void RemarkOnModes(const IdentificationProblem& problem,
                   std::vector<std::string>* remarks) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  if (problem.modal.empty() ||
      (dynamics.laws().empty() && dynamics.networks().empty())) {
    return;
  }
  remarks->push_back(
      "Measured modes are held against those of the matrices with their "
      "groups; "
      "elements, libraries and networks take no part in these.");
}

bool ReadTree(const std::shared_ptr<const TomlValue>& source,
              const std::string& path, bool simulation, Case* result,
              std::string* error) {
  CaseErrors errors(path, error);
  const TomlTable root(*source, "", &errors);
  if (!root.AllowKeys({"title", "units", "model", "group", "element", "library",
                       "network", "unknown_force", "record", "modal", "mode",
                       "options", "simulate", "discover", "damage",
                       "reference_curve"})) {
    return false;
  }
  Case c;
  c.path = path;
  c.source = source;
  ProblemDescription& description = c.problem.description;
  UnitSystem& units = description.units;
  description.title = root.String("title");
  if (!ReadUnits(root, &units) || !ReadOptions(root, &c.options) ||
      !ReadSimulate(root, &c.noise_percent, &c.noise_seed)) {
    return false;
  }
  ModelSection model;
  if (!ReadModelSection(root, units, &model)) return false;
  c.expected_hz = model.expected_hz;
  if (model.finite_element != nullptr) {
    // Its groups are added below.
    c.finite_element = std::shared_ptr<const ReducedStructure>(
        model.finite_element, &model.finite_element->structure);
  }

  // The inputs of the dynamics are known before its terms, which may look at
  // them; the numbers of the records are read after the terms, which decide
  // on the number of states.
  std::vector<RecordSection> sections;
  if (!ReadRecordSections(root, units, model.model, simulation, &sections)) {
    return false;
  }
  std::vector<InputSpec> inputs = CollectInputs(sections, model.model);
  if (!AddRecordSwitches(root, sections, &inputs)) return false;
  auto dynamics =
      std::make_shared<StructuralDynamics>(model.model, std::move(inputs));
  TermsContext context;
  context.units = &units;
  context.model = &model;
  context.default_seed = c.options.seed;
  context.remarks = &description.remarks;
  if (!ReadGroups(root, context, dynamics.get()) ||
      !ReadElements(root, context, dynamics.get()) ||
      !ReadLibraries(root, context, dynamics.get()) ||
      !ReadUnknownForces(root, context, sections, dynamics.get()) ||
      !ReadNetworks(root, context, dynamics.get()) ||
      !ReadDiscover(root, *dynamics, &c.discover) ||
      !ReadReferenceCurves(root, *dynamics, &description.reference_curves)) {
    return false;
  }
  StructuralDynamics::Prepared prepared;
  std::string message;
  if (!dynamics->Prepare(dynamics->Parameters(), &prepared, &message)) {
    return root.Fail("group", message +
                                  " with the groups' initial values, "
                                  "expected a positive definite one");
  }
  c.problem.dynamics = dynamics;

  for (const RecordSection& section : sections) {
    IdentificationRecord record;
    if (!ReadRecordData(section, units, *dynamics, simulation, &record)) {
      return false;
    }
    // Until the steps are chosen, for which the other checks must have passed.
    record.substeps = 1;
    c.problem.records.push_back(std::move(record));
  }
  if (!ReadModes(root, units, model.model, c.problem.num_train_records() > 0,
                 &c.problem.modal)) {
    return false;
  }
  RemarkOnModes(c.problem, &description.remarks);
  SpreadNetworksOfTime(root, c.problem, dynamics.get());
  if (!ReadSensors(sections, units, &c.problem) ||
      !CheckNames(c.problem, &errors)) {
    return false;
  }
  if (!simulation &&
      (!CheckUnknownForces(root, sections, c.problem, &c.options) ||
       !ReadForceTruths(root, units, sections, &description.force_truths))) {
    return false;
  }
  if (!simulation &&
      (!c.problem.IsValid(&message) || !c.options.IsValid(&message))) {
    return errors.Fail(0, message);
  }
  if (!ReadDamage(root, c.problem, &c.damage)) return false;
  for (size_t r = 0; r < sections.size(); ++r) {
    c.problem.records[r].substeps = sections[r].substeps;
  }
  int failed = 0;
  if (!SetSubsteps(&c.problem, &c.substeps, &failed, &message)) {
    return sections[static_cast<size_t>(failed)].table.Fail("substeps",
                                                            message);
  }
  *result = std::move(c);
  return true;
}

bool Read(const std::string& path, bool simulation, Case* result,
          std::string* error) {
  std::string text;
  if (!ReadTextFile(path, &text, error)) return false;
  auto source = std::make_shared<TomlValue>();
  if (!ParseToml(text, path, source.get(), error)) return false;
  return ReadTree(source, path, simulation, result, error);
}

}  // namespace

bool ReadCase(const std::string& path, Case* c, std::string* error) {
  return Read(path, false, c, error);
}

bool ReadCaseTree(const TomlValue& tree, const std::string& path, Case* c,
                  std::string* error) {
  return ReadTree(std::make_shared<TomlValue>(tree), path, false, c, error);
}

bool ReadCaseForSimulation(const std::string& path, Case* c,
                           std::string* error) {
  return Read(path, true, c, error);
}

}  // namespace pinode
