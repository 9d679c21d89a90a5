#include "pinode/case/sections/modes_section.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/case/sections/geometry_section.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/case/sections/record_data.h"
#include "pinode/case/sections/record_section.h"
#include "pinode/case/text/case_tables.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/record/table.h"

namespace pinode {
namespace {

void AddOnce(const std::string& name, std::vector<std::string>* names) {
  if (!name.empty() &&
      std::find(names->begin(), names->end(), name) == names->end()) {
    names->push_back(name);
  }
}

// Returns a model whose DOFs are all places that records name. Its matrices are
// not used.
StructuralModel PlacesOfRecords(const TomlTable& root) {
  std::vector<std::string> places;
  std::vector<std::string> directions;
  for (const TomlTable& record : root.Tables("record")) {
    for (const TomlTable& channel : record.Tables("channel", "record")) {
      if (channel.Has("combination")) {
        for (const auto& entry :
             channel.Table("combination", "combination").entries()) {
          AddOnce(entry.first, &places);
        }
      } else if (channel.Has("dof")) {
        AddOnce(channel.String("dof"), &places);
      } else {
        AddOnce(channel.String("name", channel.String("column")), &places);
      }
    }
    for (const char* kind : {"force", "motion"}) {
      for (const TomlTable& input : record.Tables(kind, "record")) {
        AddOnce(input.String("dof"), &places);
      }
    }
    for (const TomlTable& ground : record.Tables("ground", "record")) {
      AddOnce(ground.String("direction"), &directions);
    }
  }
  const Eigen::Index size = static_cast<Eigen::Index>(places.size());
  StructuralModel model = MakeStructuralModel(
      Matrix::Identity(size, size), Matrix::Zero(size, size),
      Matrix::Identity(size, size), places);
  if (!directions.empty()) {
    model.directions = directions;
    model.influence =
        Matrix::Ones(size, static_cast<Eigen::Index>(directions.size()));
    model.support_mass_coupling =
        Matrix::Zero(size, static_cast<Eigen::Index>(directions.size()));
  }
  return model;
}

constexpr ModalMethod kModalMethods[] = {
    ModalMethod::kAutomatic, ModalMethod::kCovarianceDriven,
    ModalMethod::kDataDriven, ModalMethod::kInputOutput,
    ModalMethod::kRingDown};

// True if an input is a measured load, not derived from one.
bool IsLoad(const InputSpec& spec) {
  return spec.kind == InputSpec::Kind::kGroundAcceleration ||
         spec.kind == InputSpec::Kind::kForce ||
         spec.kind == InputSpec::Kind::kPrescribedDisplacement;
}

class ModesCaseReader {
 public:
  ModesCaseReader(const TomlValue& source, const std::string& path,
                  const CaseData* data, std::string* error)
      : errors_(path, error, data), root_(source, "", &errors_) {
    c_.path = path;
  }

  bool ReadOptionsAlone(ModesCase* result) {
    if (!root_.AllowKeys({"modes"}) || !ReadOptions()) return false;
    *result = std::move(c_);
    return true;
  }

  bool Read(ModesCase* result) {
    c_.title = root_.String("title");
    if (!AllowCaseTables(root_) || !ReadUnits(root_, &c_.units) ||
        !ReadOptions() || !ReadRecords() ||
        !ReadGeometry(root_, root_.Has("model") ? nullptr : &dof_names_,
                      nullptr, &c_.geometry)) {
      return false;
    }
    *result = std::move(c_);
    return true;
  }

 private:
  bool ReadOptions() {
    const TomlTable table = root_.Table("modes", "[modes]");
    if (!table.AllowKeys()) {
      return false;
    }
    for (const TomlValue::Entry& entry : table.entries()) {
      c_.option_lines[entry.first] = table.Line(entry.first);
    }
    ModeIdentificationOptions& options = c_.options;
    if (table.Has("lowest_hz")) {
      options.lowest_hz = table.PositiveNumber("lowest_hz", 1.0);
    }
    if (table.Has("highest_hz")) {
      options.highest_hz = table.PositiveNumber("highest_hz", 1.0);
    }
    options.block_rows = table.Integer("block_rows", 0, 2, 10000);
    options.max_order = table.Integer("max_order", 0, 2, 10000);
    if (table.errors()->ok() && options.max_order % 2 != 0) {
      return table.Fail("max_order",
                        "'max_order' is odd, expected an even number, because "
                        "a mode has two states");
    }
    std::vector<std::string> methods;
    for (const ModalMethod method : kModalMethods) {
      methods.emplace_back(ModalMethodName(method));
    }
    const std::string wanted = table.Choice("method", methods, methods.front());
    for (const ModalMethod method : kModalMethods) {
      if (wanted == ModalMethodName(method)) options.method = method;
    }
    options.references = table.Strings("references");
    c_.merge.references = options.references;
    options.stabilisation.largest_damping_ratio = table.PositiveNumber(
        "max_damping_ratio", options.stabilisation.largest_damping_ratio);
    options.num_threads = table.Integer("threads", DefaultThreads(), 1, 1024);
    options.stabilisation.pick = table.Numbers("pick");
    c_.keep_harmonics = table.Boolean("harmonics", false);
    return table.errors()->ok() && ReadFrf(table);
  }

  bool ReadFrf(const TomlTable& table) {
    if (!table.Has("frf")) return true;
    if (c_.options.method != ModalMethod::kAutomatic) {
      return table.Fail("method",
                        "[modes.frf] has a method of its own, expected no "
                        "'method'");
    }
    for (const char* key : {"references", "block_rows", "harmonics"}) {
      if (!table.Has(key)) continue;
      return table.Fail(key, "[modes.frf] does not use '" + std::string(key) +
                                 "', expected no such key");
    }
    c_.frf.emplace();
    return ReadModesFrfSection(table.Table("frf", "[modes.frf]"), &*c_.frf);
  }

  bool ReadRecords() {
    const StructuralModel places = PlacesOfRecords(root_);
    dof_names_ = places.dof_names;
    std::vector<RecordSection> sections;
    if (!errors_.ok() ||
        !ReadRecordSections(root_, c_.units, places, RecordPurpose::kResponses,
                            &sections)) {
      return false;
    }
    inputs_ = CollectInputs(sections, places);
    const StructuralDynamics dynamics(places, inputs_);
    double second = 1.0;
    std::string message;
    if (!UnitFactor("s", Dimension::kTime, c_.units, &second, &message)) {
      return errors_.Fail(0, message);
    }
    for (const RecordSection& section : sections) {
      IdentificationRecord record;
      if (!ReadRecordData(section, c_.units, dynamics, /*simulation=*/false,
                          &record, /*faults=*/nullptr) ||
          !AddRecord(section, record, places.dof_names, second)) {
        return false;
      }
    }
    return true;
  }

  bool AddRecord(const RecordSection& section,
                 const IdentificationRecord& record,
                 const std::vector<std::string>& dof_names, double second) {
    ResponseRecord response;
    response.name = record.name;
    response.sampling_step = record.sampling_step() / second;
    response.samples.resize(static_cast<Eigen::Index>(record.channels.size()),
                            record.num_samples());
    for (size_t c = 0; c < record.channels.size(); ++c) {
      const ChannelSection& channel = section.channels[c];
      const int derivative = Derivative(channel.quantity);
      if (derivative < 0) {
        return channel.signal.table.Fail(
            "quantity",
            std::string("a ") + QuantityName(channel.quantity) +
                " has no mode shape, expected a motion or a strain");
      }
      if (c_.frf.has_value() && channel.quantity == Quantity::kStrain) {
        return channel.signal.table.Fail(
            "quantity",
            "frequency response functions of [modes.frf] are of motions, "
            "expected a displacement, velocity or acceleration");
      }
      response.channels.push_back({channel.location, derivative});
      AddPlace(channel, dof_names);
      response.samples.row(static_cast<Eigen::Index>(c)) =
          record.channels[c].values.transpose();
    }
    for (const std::string& remark : record.description.remarks) {
      c_.remarks.push_back("Record '" + record.name + "': " + remark);
    }
    RemarkOnCovariates(record);
    if (c_.frf.has_value() && section.free_decay) {
      return section.table.Fail(
          "excitation",
          "[modes.frf] needs a measured force, expected no free decay");
    }
    response.free_decay = section.free_decay;
    c_.loads.emplace_back();
    if (section.has_excitation()) {
      AddInputs(record, dof_names, &response);
      if (c_.options.method == ModalMethod::kCovarianceDriven ||
          c_.options.method == ModalMethod::kDataDriven) {
        c_.remarks.push_back(
            "Record '" + record.name +
            "' has a measured excitation, which this method does not use. If "
            "its spectrum is narrow, its own frequencies appear as modes.");
      }
    }
    std::string message;
    if (!response.IsValid(&message)) {
      return section.table.Fail("channel", message);
    }
    c_.record_lines[response.name] = section.table.line();
    c_.records.push_back(std::move(response));
    return true;
  }

  // Adds a place. A strain is no motion of its DOFs.
  void AddPlace(const ChannelSection& channel,
                const std::vector<std::string>& dof_names) {
    const bool known = std::any_of(c_.places.begin(), c_.places.end(),
                                   [&channel](const PlaceOfShape& other) {
                                     return other.place == channel.location;
                                   });
    if (known) return;
    PlaceOfShape place = {channel.location, channel.name, {}};
    for (Eigen::Index i = 0; i < channel.weights.size(); ++i) {
      if (channel.weights[i] == 0.0 || channel.quantity == Quantity::kStrain) {
        continue;
      }
      place.dofs[dof_names[static_cast<size_t>(i)]] = channel.weights[i];
    }
    c_.places.push_back(std::move(place));
  }

  // Adds the place of a force, which shapes of a roving hammer have.
  void AddForcePlace(const std::string& dof) {
    const auto is_it = [&dof](const PlaceOfShape& other) {
      return other.place == dof;
    };
    if (!c_.frf.has_value() ||
        std::any_of(c_.places.begin(), c_.places.end(), is_it)) {
      return;
    }
    c_.places.push_back({dof, dof, {{dof, 1.0}}});
  }

  // Adds a remark on covariates: modes belong to one state of the structure,
  // and a case must give its covariates.
  void RemarkOnCovariates(const IdentificationRecord& record) {
    for (size_t i = 0; i < inputs_.size(); ++i) {
      if (inputs_[i].kind != InputSpec::Kind::kCovariate) continue;
      const double mean =
          record.excitation->samples().row(static_cast<Eigen::Index>(i)).mean();
      c_.remarks.push_back(
          "Record '" + record.name + "': the mean of " + inputs_[i].name +
          " is " + FormatNumber(mean, 5) +
          ". For a case with these modes set it in [modal] covariates.");
    }
  }

  // Adds inputs that vary; those of other records are zero here.
  void AddInputs(const IdentificationRecord& record,
                 const std::vector<std::string>& dof_names,
                 ResponseRecord* response) {
    const Matrix& samples = record.excitation->samples();
    std::vector<Eigen::Index> rows;
    for (size_t i = 0; i < inputs_.size(); ++i) {
      const Eigen::Index row = static_cast<Eigen::Index>(i);
      if (IsLoad(inputs_[i]) &&
          samples.row(row).maxCoeff() > samples.row(row).minCoeff()) {
        rows.push_back(row);
        const bool is_force = inputs_[i].kind == InputSpec::Kind::kForce;
        c_.loads.back().push_back(
            is_force ? dof_names[static_cast<size_t>(inputs_[i].index)] : "");
        if (is_force) AddForcePlace(c_.loads.back().back());
      }
    }
    response->inputs.resize(static_cast<Eigen::Index>(rows.size()),
                            samples.cols());
    for (size_t i = 0; i < rows.size(); ++i) {
      response->inputs.row(static_cast<Eigen::Index>(i)) = samples.row(rows[i]);
    }
  }

  // Returns the order of the derivative; -1: none.
  static int Derivative(Quantity quantity) {
    switch (quantity) {
      case Quantity::kDisplacement:
      case Quantity::kAbsoluteDisplacement:
      case Quantity::kStrain:
        return 0;
      case Quantity::kVelocity:
        return 1;
      case Quantity::kRelativeAcceleration:
      case Quantity::kAbsoluteAcceleration:
        return 2;
      case Quantity::kForce:
        break;
    }
    return -1;
  }

  ModesCase c_;
  std::vector<InputSpec> inputs_;
  // DOFs named in the records; the only ones without a model.
  std::vector<std::string> dof_names_;
  CaseErrors errors_;
  const TomlTable root_;
};

}  // namespace

bool ReadModesCase(const std::string& path, ModesCase* c, std::string* error) {
  std::string text;
  TomlValue source;
  return ReadTextFile(path, &text, error) &&
         ParseToml(text, path, &source, error) &&
         ModesCaseReader(source, path, nullptr, error).Read(c);
}

bool ReadModesOptions(const TomlValue& source, const std::string& path,
                      ModesCase* c, std::string* error) {
  return ModesCaseReader(source, path, nullptr, error).ReadOptionsAlone(c);
}

bool ReadModesTree(const TomlValue& source, const std::string& path,
                   const CaseData* data, ModesCase* c, std::string* error) {
  return ModesCaseReader(source, path, data, error).Read(c);
}

}  // namespace pinode
