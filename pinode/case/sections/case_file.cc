#include "pinode/case/sections/case_file.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>
#include <system_error>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/ambient_section.h"
#include "pinode/case/sections/damage_section.h"
#include "pinode/case/sections/discover_section.h"
#include "pinode/case/sections/finite_element_section.h"
#include "pinode/case/sections/force_scale_section.h"
#include "pinode/case/sections/frf_section.h"
#include "pinode/case/sections/geometry_section.h"
#include "pinode/case/sections/library_section.h"
#include "pinode/case/sections/modal_section.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/sections/options_section.h"
#include "pinode/case/sections/plan_section.h"
#include "pinode/case/sections/record_data.h"
#include "pinode/case/sections/record_files.h"
#include "pinode/case/sections/record_section.h"
#include "pinode/case/sections/reference_curve_section.h"
#include "pinode/case/sections/sensors_section.h"
#include "pinode/case/sections/shared_tables.h"
#include "pinode/case/sections/terms_section.h"
#include "pinode/case/sections/unknown_force_section.h"
#include "pinode/case/text/case_tables.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/estimate/start/free_run_start.h"
#include "pinode/study/problem/network_scales.h"

namespace pinode {
namespace {

// Checks that names of parameters are unique over all terms and sensors.
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

// Checks what unknowns are tied to. In a case a fixed source is a mistake: the
// tied unknown would be fixed too.
bool CheckTies(const IdentificationProblem& problem, CaseErrors* errors) {
  const std::vector<const ParameterBlock*> blocks = problem.ParameterBlocks();
  const auto fail = [errors](const std::string& name, const std::string& what) {
    return errors->Fail(errors->LineOfTie(name),
                        "unknown '" + name + "': " + what);
  };
  std::string tied;
  std::string error;
  if (!problem.HasValidTies(&tied, &error)) return fail(tied, error);
  std::vector<const Parameter*> all;
  for (const ParameterBlock* block : blocks) {
    for (const Parameter& parameter : block->parameters) {
      all.push_back(&parameter);
    }
  }
  for (const ParameterTie& tie : FindTies(blocks)) {
    const Parameter& source = *all[static_cast<size_t>(tie.source)];
    if (source.free) continue;
    return fail(all[static_cast<size_t>(tie.parameter)]->name,
                "it is tied to '" + source.name +
                    "', which is fixed; free that one, or give this one the "
                    "value itself");
  }
  return true;
}

// Adds a remark on the modes' model if other terms are not included in it.
void RemarkOnModes(const IdentificationProblem& problem,
                   std::vector<std::string>* remarks) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  if (problem.modal.empty()) return;
  const std::vector<std::string> followers = dynamics.CovariateParameters();
  if (!followers.empty() && problem.modal.inputs.size() == 0) {
    remarks->push_back(
        "[modal] has no 'covariates', so the measured modes are taken at the "
        "reference of groups that follow a covariate: " +
        Join(followers, ", ") + " take no part in them.");
  }
  if (dynamics.laws().empty() && dynamics.networks().empty()) return;
  remarks->push_back(
      "Measured modes are compared with the modes of the matrices and their "
      "groups, without elements, libraries and networks.");
}

// Reads the sections in the order of their dependence.
class CaseReader {
 public:
  CaseReader(const std::shared_ptr<const TomlValue>& source,
             const std::string& path, std::shared_ptr<const CaseData> data,
             CasePurpose purpose, std::string* error)
      : simulation_(purpose == CasePurpose::kSimulation ||
                    purpose == CasePurpose::kPlanning),
        planning_(purpose == CasePurpose::kPlanning),
        model_may_stand_alone_(purpose == CasePurpose::kCheck),
        errors_(path, error, data.get()),
        root_(*source, "", &errors_),
        description_(c_.problem.description),
        units_(description_.units) {
    c_.path = path;
    c_.source = source;
    c_.data = std::move(data);
  }

  void ReadWith(SharedTables* tables) { errors_.set_shared_tables(tables); }

  bool Read(Case* result) {
    if (!ReadHead() || !ReadModel() || !ReadDynamics() || !ReadData() ||
        !Check() || !ReadDamage(root_, c_.problem, &c_.damage) ||
        !ReadProfiles(root_, c_.problem, &c_.profiles) || !SetSteps() ||
        (planning_ && !ReadPlan(root_, units_, c_.finite_element.get(),
                                sections_, c_.problem, &c_.plan))) {
      return false;
    }
    if (!simulation_) FixTrainingStarts(&c_.problem);
    *result = std::move(c_);
    return true;
  }

 private:
  bool ReadHead() {
    if (!AllowCaseTables(root_)) {
      return false;
    }
    description_.title = root_.String("title");
    return ReadUnits(root_, &units_) && ReadOptions(root_, &c_.options) &&
           ReadSimulate(root_, &c_.noise_percent, &c_.noise_is_sigma,
                        &c_.noise_seed);
  }

  bool ReadModel() {
    if (!ReadModelSection(root_, units_, &model_)) return false;
    c_.expected_hz = model_.expected_hz;
    if (model_.finite_element != nullptr) {
      // Groups are added to it below.
      c_.finite_element = std::shared_ptr<const ReducedStructure>(
          model_.finite_element, &model_.finite_element->structure);
    }
    return true;
  }

  // Reads the inputs of the dynamics before its terms, which may use them. The
  // numbers of the records are read after the terms, which determine the number
  // of states.
  bool ReadDynamics() {
    if (!ReadRecordSections(root_, units_, model_.model,
                            planning_     ? RecordPurpose::kPlanning
                            : simulation_ ? RecordPurpose::kSimulation
                                          : RecordPurpose::kFit,
                            &sections_)) {
      return false;
    }
    std::vector<InputSpec> inputs = CollectInputs(sections_, model_.model);
    SetAmbientApart();
    if (!AddModalCovariates(root_, &inputs)) return false;
    if (!AddRecordSwitches(root_, sections_, &inputs)) return false;
    AddScaleSwitches(sections_, &inputs);
    dynamics_ =
        std::make_shared<StructuralDynamics>(model_.model, std::move(inputs));
    TermsContext context;
    context.units = &units_;
    context.model = &model_;
    context.default_seed = c_.options.seed;
    context.remarks = &description_.remarks;
    context.candidates = &c_.candidates;
    if (!ReadGroups(root_, context, dynamics_.get()) ||
        !ReadElements(root_, context, dynamics_.get()) ||
        !ReadLibraries(root_, context, dynamics_.get()) ||
        !ReadUnknownForces(root_, context, sections_, dynamics_.get()) ||
        !ReadForceScales(sections_, context, dynamics_.get()) ||
        !ReadNetworks(root_, context, dynamics_.get()) ||
        !ReadDiscover(root_, *dynamics_, &c_.discover) ||
        !ReadReferenceCurves(root_, *dynamics_,
                             &description_.reference_curves)) {
      return false;
    }
    StructuralDynamics::Prepared prepared;
    std::string message;
    if (!dynamics_->Prepare(dynamics_->Parameters(), &prepared, &message)) {
      return root_.Fail("group", message +
                                     " with the groups' initial values, "
                                     "expected a positive definite one");
    }
    c_.problem.dynamics = dynamics_;
    std::vector<std::string> group_names;
    for (const GroupTerm& term : dynamics_->groups()) {
      group_names.push_back(term.group.name);
    }
    return ReadGeometry(root_,
                        c_.finite_element != nullptr
                            ? &c_.finite_element->exported.dof_names
                            : &dynamics_->model().dof_names,
                        &group_names, &c_.geometry);
  }

  // Returns the tables that the sections name, in the order of reading.
  std::vector<SharedTables::Wanted> Tables() const {
    std::vector<SharedTables::Wanted> all;
    for (const auto* sections : {&sections_, &ambient_sections_}) {
      for (const RecordSection& section : *sections) {
        const auto own = RecordFiles::TablesOf(section, simulation_);
        all.insert(all.end(), own.begin(), own.end());
      }
    }
    return all;
  }

  bool ReadData() {
    IdentificationProblem& problem = c_.problem;
    if (errors_.shared_tables() != nullptr) {
      errors_.shared_tables()->Plan(Tables());
    }
    for (const RecordSection& section : sections_) {
      IdentificationRecord record;
      if (!ReadRecordData(section, units_, *dynamics_, simulation_, &record,
                          &description_.remarks)) {
        return false;
      }
      // Placeholder until the steps are chosen, which requires that the other
      // checks have passed.
      record.substeps = 1;
      problem.records.push_back(std::move(record));
    }
    if (!ReadAmbientRecords(ambient_sections_, units_, *dynamics_, &problem) ||
        !ReadModes(root_, units_, model_.model, dynamics_->inputs(),
                   problem.num_train_records() > 0 || problem.HasSpectra() ||
                       root_.Has("frf"),
                   &problem.modal)) {
      return false;
    }
    RemarkOnModes(problem, &description_.remarks);
    SpreadNetworksOfTime(root_, problem, dynamics_.get());
    if (!ReadSensors(sections_, units_, &problem) ||
        (!simulation_ &&
         !ReadFrfSections(root_, units_, model_.model, &problem))) {
      return false;
    }
    ScaleNetworks(problem, dynamics_.get());
    return true;
  }

  void SetAmbientApart() {
    const auto first = std::stable_partition(
        sections_.begin(), sections_.end(),
        [](const RecordSection& section) { return !section.ambient; });
    ambient_sections_.assign(std::make_move_iterator(first),
                             std::make_move_iterator(sections_.end()));
    sections_.erase(first, sections_.end());
  }

  bool Check() {
    if (!CheckNames(c_.problem, &errors_) || !CheckTies(c_.problem, &errors_)) {
      return false;
    }
    if (simulation_) return planning_ || CheckNoise();
    if (model_may_stand_alone_ && c_.problem.records.empty() &&
        c_.problem.modal.empty() && !c_.problem.HasSpectra()) {
      return true;
    }
    if (!CheckUnknownForces(root_, sections_, c_.problem, &c_.options) ||
        !ReadForceTruths(root_, units_, sections_,
                         &description_.force_truths)) {
      return false;
    }
    std::string message;
    return (c_.problem.IsValid(&message) && c_.options.IsValid(&message) &&
            AreCandidatesOf(c_.problem, c_.candidates, &message)) ||
           errors_.Fail(0, message);
  }

  // Checks simulations with noise from each channel's sigma.
  bool CheckNoise() {
    for (size_t r = 0; c_.noise_is_sigma && r < sections_.size(); ++r) {
      for (size_t c = 0; c < sections_[r].channels.size(); ++c) {
        if (c_.problem.records[r].channels[c].sigma > 0.0) continue;
        return sections_[r].channels[c].signal.table.Fail(
            "sigma",
            "'sigma' is missing, expected with noise = \"sigma\" in "
            "[simulate]");
      }
    }
    return true;
  }

  bool SetSteps() {
    for (size_t r = 0; r < sections_.size(); ++r) {
      c_.problem.records[r].substeps = sections_[r].substeps;
      c_.problem.records[r].integrator = sections_[r].integrator;
    }
    // Steps fine enough for sensors at any place.
    std::vector<size_t> own;
    for (IdentificationRecord& record : c_.problem.records) {
      own.push_back(record.channels.size());
      for (int i = 0; planning_ && i < dynamics_->num_dofs(); ++i) {
        MeasuredChannel channel;
        channel.observation.name =
            dynamics_->model().dof_names[static_cast<size_t>(i)];
        channel.observation.quantity = Quantity::kAbsoluteAcceleration;
        channel.observation.weights = Vector::Unit(dynamics_->num_dofs(), i);
        channel.values = Vector::Zero(record.num_samples());
        record.channels.push_back(std::move(channel));
      }
    }
    int failed = 0;
    std::string message;
    const bool chosen =
        SetSubsteps(&c_.problem, &c_.substeps, &failed, &message);
    for (size_t r = 0; r < own.size(); ++r) {
      c_.problem.records[r].channels.resize(own[r]);
    }
    return chosen || sections_[static_cast<size_t>(failed)].table.Fail(
                         "substeps", message);
  }

  const bool simulation_;
  const bool planning_;
  const bool model_may_stand_alone_;
  Case c_;
  CaseErrors errors_;
  const TomlTable root_;
  ProblemDescription& description_;
  UnitSystem& units_;
  ModelSection model_;
  std::vector<RecordSection> sections_;
  std::vector<RecordSection> ambient_sections_;
  std::shared_ptr<StructuralDynamics> dynamics_;
};

bool ReadSourceTree(const std::string& path, TomlValue* source,
                    std::string* error) {
  std::string text;
  if (ReadTextFile(path, &text, error) &&
      ParseToml(text, path, source, error)) {
    return true;
  }
  // A file of records in place of a case is a common slip.
  std::error_code unused;
  if (std::filesystem::path(path).extension() != ".toml" &&
      std::filesystem::is_regular_file(path, unused)) {
    *error +=
        ". A case is a TOML file. If this is a file of records, "
        "pinode_new drafts a case from it, and pinode_modes takes it "
        "with --columns=all";
  }
  return false;
}

bool Read(const std::string& path, CasePurpose purpose, Case* result,
          std::string* error) {
  auto source = std::make_shared<TomlValue>();
  if (!ReadSourceTree(path, source.get(), error)) return false;
  return CaseReader(source, path, nullptr, purpose, error).Read(result);
}

}  // namespace

bool ReadCase(const std::string& path, Case* c, std::string* error) {
  return Read(path, CasePurpose::kFit, c, error);
}

bool ReadCase(const std::string& path, SharedTables* tables, Case* c,
              std::string* error) {
  auto source = std::make_shared<TomlValue>();
  if (!ReadSourceTree(path, source.get(), error)) return false;
  CaseReader reader(source, path, nullptr, CasePurpose::kFit, error);
  reader.ReadWith(tables);
  return reader.Read(c);
}

bool ReadCaseTree(const TomlValue& tree, const std::string& path,
                  std::shared_ptr<const CaseData> data, CasePurpose purpose,
                  Case* c, std::string* error) {
  return CaseReader(std::make_shared<TomlValue>(tree), path, std::move(data),
                    purpose, error)
      .Read(c);
}

bool ReadCaseForCheck(const std::string& path, Case* c, std::string* error) {
  return Read(path, CasePurpose::kCheck, c, error);
}

bool ReadCaseForSimulation(const std::string& path, Case* c,
                           std::string* error) {
  return Read(path, CasePurpose::kSimulation, c, error);
}

bool ReadCaseForPlanning(const std::string& path, const std::string& force_dof,
                         Case* c, std::string* error) {
  auto source = std::make_shared<TomlValue>();
  if (!ReadSourceTree(path, source.get(), error) ||
      !MoveForces(path, force_dof, source.get(), error)) {
    return false;
  }
  return CaseReader(source, path, nullptr, CasePurpose::kPlanning, error)
      .Read(c);
}

IdentificationExtras ExtrasOf(const Case& c) {
  IdentificationExtras extras;
  extras.candidates = c.candidates;
  extras.reduced = c.finite_element;
  return extras;
}

}  // namespace pinode
