#include "pinode/case/case_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/discover_section.h"
#include "pinode/case/library_section.h"
#include "pinode/case/model_section.h"
#include "pinode/case/options_section.h"
#include "pinode/case/record_data.h"
#include "pinode/case/record_section.h"
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

// A model carries the error of the steps with which it was fitted. Where steps
// are chosen, no record is integrated more coarsely than the finest training
// record.
void RefineToTraining(Case* c) {
  double finest = std::numeric_limits<double>::infinity();
  for (const IdentificationRecord& record : c->problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    finest = std::min(finest, record.sampling_step() / record.substeps);
  }
  for (size_t r = 0; r < c->records.size(); ++r) {
    IdentificationRecord& record = c->problem.records[r];
    SubstepChoice& choice = c->records[r].substeps;
    const double needed =
        std::ceil(record.sampling_step() / finest * (1.0 - 1e-9));
    if (c->records[r].substeps_given || !(needed > record.substeps) ||
        needed > kMaxSubsteps) {
      continue;
    }
    record.substeps = choice.substeps = static_cast<int>(needed);
    choice.stability =
        CheckStability(StateMatrixAtRest(*c->problem.dynamics, record),
                       record.sampling_step(), record.substeps);
  }
}

bool SetSubsteps(const std::vector<RecordSection>& sections, Case* c) {
  for (size_t r = 0; r < sections.size(); ++r) {
    const RecordSection& section = sections[r];
    IdentificationRecord& record = c->problem.records[r];
    CaseRecord& info = c->records[r];
    info.substeps_given = section.substeps > 0;
    std::string error;
    const bool good =
        info.substeps_given
            ? CheckSubsteps(*c->problem.dynamics, record, section.substeps,
                            &info.substeps, &error)
            : ChooseSubsteps(*c->problem.dynamics, record, &info.substeps,
                             &error);
    if (!good) return section.table.Fail("substeps", error);
    record.substeps = info.substeps.substeps;
  }
  RefineToTraining(c);
  return true;
}

bool ReadTree(const std::shared_ptr<const TomlValue>& source,
              const std::string& path, bool simulation, Case* result,
              std::string* error) {
  CaseErrors errors(path, error);
  const TomlTable root(*source, "", &errors);
  if (!root.AllowKeys({"title", "units", "model", "group", "element", "library",
                       "network", "unknown_force", "record", "options",
                       "simulate", "discover", "damage", "reference_curve"})) {
    return false;
  }
  Case c;
  c.path = path;
  c.source = source;
  c.title = root.String("title");
  if (!ReadUnits(root, &c.units) || !ReadOptions(root, &c.options) ||
      !ReadSimulate(root, &c.noise_percent, &c.noise_seed)) {
    return false;
  }
  ModelSection model;
  if (!ReadModelSection(root, c.units, &model)) return false;
  c.expected_hz = model.expected_hz;
  c.finite_element = model.finite_element;

  // The inputs of the dynamics are known before its terms, which may look at
  // them; the numbers of the records are read after the terms, which decide
  // on the number of states.
  std::vector<RecordSection> sections;
  if (!ReadRecordSections(root, c.units, model.model, simulation, &sections)) {
    return false;
  }
  std::vector<InputSpec> inputs = CollectInputs(sections, model.model);
  if (!AddRecordSwitches(root, sections, &inputs)) return false;
  auto dynamics =
      std::make_shared<StructuralDynamics>(model.model, std::move(inputs));
  TermsContext context;
  context.units = &c.units;
  context.model = &model;
  context.default_seed = c.options.seed;
  context.remarks = &c.remarks;
  if (!ReadGroups(root, context, dynamics.get()) ||
      !ReadElements(root, context, dynamics.get()) ||
      !ReadLibraries(root, context, dynamics.get()) ||
      !ReadUnknownForces(root, context, sections, dynamics.get()) ||
      !ReadNetworks(root, context, dynamics.get()) ||
      !ReadDiscover(root, *dynamics, &c.discover) ||
      !ReadReferenceCurves(root, *dynamics, &c.reference_curves)) {
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
    CaseRecord info;
    if (!ReadRecordData(section, c.units, *dynamics, simulation, &record,
                        &info)) {
      return false;
    }
    c.problem.records.push_back(std::move(record));
    c.records.push_back(std::move(info));
  }
  SpreadNetworksOfTime(root, c.problem, dynamics.get());
  if (!ReadSensors(sections, c.units, &c.problem) ||
      !CheckNames(c.problem, &errors)) {
    return false;
  }
  if (!simulation &&
      (!CheckUnknownForces(root, sections, c.problem, &c.options) ||
       !ReadForceTruths(root, c.units, sections, &c.force_truths))) {
    return false;
  }
  if (!simulation &&
      (!c.problem.IsValid(&message) || !c.options.IsValid(&message))) {
    return errors.Fail(0, message);
  }
  if (!ReadDamage(root, c.problem, &c.damage) || !SetSubsteps(sections, &c)) {
    return false;
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

double Case::HzPerModelFrequency() const {
  double factor = 1.0;
  std::string error;
  // `units` was checked when the case was read.
  return UnitFactor("s", Dimension::kTime, units, &factor, &error) ? factor
                                                                   : 1.0;
}

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
