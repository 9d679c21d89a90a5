#include "pinode/case/sections/modes_section.h"

#include <algorithm>
#include <cctype>
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
#include "pinode/record/files/array_table.h"
#include "pinode/record/files/text_table.h"
#include "pinode/record/files/universal_file.h"
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
      response.channels.push_back({channel.location, derivative});
      AddPlace(channel, dof_names);
      response.samples.row(static_cast<Eigen::Index>(c)) =
          record.channels[c].values.transpose();
    }
    for (const std::string& remark : record.description.remarks) {
      c_.remarks.push_back("Record '" + record.name + "': " + remark);
    }
    RemarkOnCovariates(record);
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

// Returns true for "t", "time", and these with a unit behind them: "Time [s]".
bool IsNameOfTime(const std::string& name) {
  size_t end = 0;
  std::string word;
  while (end < name.size() &&
         std::isalpha(static_cast<unsigned char>(name[end])) != 0) {
    word += static_cast<char>(
        std::tolower(static_cast<unsigned char>(name[end++])));
  }
  if (word != "t" && word != "time") return false;
  return end == name.size() ||
         std::string(" _([/").find(name[end]) != std::string::npos;
}

// Returns true if all steps are equal, up to rounding of the values.
bool IsUniformRamp(const Vector& values) {
  const Eigen::Index count = values.size();
  if (count < 3 || !values.allFinite()) return false;
  const double step =
      (values[count - 1] - values[0]) / static_cast<double>(count - 1);
  if (!(step > 0.0)) return false;
  const Vector ramp = Vector::LinSpaced(count, values[0], values[count - 1]);
  return (values - ramp).cwiseAbs().maxCoeff() < 0.6 * step;
}

// Converts a single data file to an equivalent case.
class DataFileReader {
 public:
  DataFileReader(const ModesDataFile& file, std::string* error)
      : file_(file), columns_(file.columns), error_(error) {}

  bool Read(ModesCase* c) {
    if (!FindTime() || !FindColumns() || !FindQuantities() || !FindUnits()) {
      return false;
    }
    TomlValue record = TomlValue::Table();
    record.Set("name", TomlValue::String(RecordName(file_.path)));
    record.Set("file", TomlValue::String(FileName(file_.path)));
    if (time_.empty()) {
      record.Set("sampling_rate_hz", TomlValue::Float(file_.sampling_rate_hz));
    } else {
      record.Set("time", TomlValue::String(time_));
    }
    TomlValue channels = TomlValue::Array({});
    for (size_t i = 0; i < columns_.size(); ++i) {
      TomlValue channel = TomlValue::Table();
      channel.Set("column", TomlValue::String(columns_[i]));
      channel.Set("quantity", TomlValue::String(quantities_[i]));
      channel.Set("unit",
                  TomlValue::String(units_[i].empty() ? "model" : units_[i]));
      channels.elements.push_back(std::move(channel));
    }
    record.Set("channel", std::move(channels));
    TomlValue root = TomlValue::Table();
    TomlValue units = TomlValue::Table();
    units.Set("time", TomlValue::String("s"));
    root.Set("units", std::move(units));
    root.Set("title", TomlValue::String("Modes of " + FileName(file_.path)));
    root.Set("record", TomlValue::Array({std::move(record)}));
    if (!ModesCaseReader(root, file_.path, nullptr, error_).Read(c)) {
      return false;
    }
    c->remarks.insert(c->remarks.end(), remarks_.begin(), remarks_.end());
    return true;
  }

 private:
  // The name of the file, with '_' for what no record may be called: loggers
  // write "Messung 1 (neu).csv".
  static std::string RecordName(const std::string& path) {
    std::string name = FileName(path).substr(0, 100);
    for (char& c : name) {
      const bool is_allowed =
          std::isalnum(static_cast<unsigned char>(c)) != 0 ||
          static_cast<unsigned char>(c) >= 0x80 || c == '_' || c == '-' ||
          c == '.' || c == '+';
      if (!is_allowed) c = '_';
    }
    if (name[0] == '.') name[0] = '_';
    return name;
  }
  static std::string FileName(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
  }

  bool Fail(const std::string& message) {
    *error_ = file_.path + ": " + message;
    return false;
  }

  bool FindTime() {
    if (!file_.time_column.empty() && file_.sampling_rate_hz != 0.0) {
      return Fail(
          "a time column and a sampling rate are both given, expected one of "
          "them");
    }
    if (IsTextFile(file_.path) &&
        !ReadTextOutline(file_.path, {}, &outline_, error_)) {
      return false;
    }
    time_ = file_.time_column;
    if (!time_.empty() || file_.sampling_rate_hz != 0.0) return true;
    if (outline_.time_column >= 0) {
      time_ = outline_.columns[static_cast<size_t>(outline_.time_column)].name;
      return true;
    }
    if (!IsTextFile(file_.path)) {
      Table table;
      std::string missing;
      for (const char* name : {"t", "time"}) {
        if (ReadTable(file_.path, {name}, {}, &table, &missing)) {
          time_ = name;
          return true;
        }
      }
      // The reader's error message applies if the file is no table.
      if (!ReadTable(file_.path, {}, {}, &table, error_)) return false;
    }
    return Fail(
        "no column is recognised as the time; expected one named 't' or "
        "'time', clock times, the name of the time column, or a sampling rate");
  }

  const std::string& NameOf(int column) const {
    return outline_.columns[static_cast<size_t>(column)].name;
  }

  bool FindColumns() {
    if (columns_.size() != 1 || columns_[0] != "all") return true;
    columns_.clear();
    if (outline_.second_clock >= 0) {
      return Fail("the times of '" + NameOf(outline_.time_column) + "' and '" +
                  NameOf(outline_.second_clock) +
                  "' differ, and a column may belong to either; expected the "
                  "time and the columns of one of them");
    }
    std::vector<std::string> texts, times;
    for (size_t i = 0; i < outline_.columns.size(); ++i) {
      const std::string& name = outline_.columns[i].name;
      if (!outline_.is_channel[i] && IsNameOfTime(name) && name != time_) {
        times.push_back(name);
      }
      if (outline_.columns[i].kind == CellKind::kText) {
        texts.push_back(outline_.columns[i].name);
      }
      if (outline_.is_channel[i] && outline_.columns[i].name != time_) {
        columns_.push_back(outline_.columns[i].name);
      }
    }
    if (!texts.empty()) {
      remarks_.push_back(
          "Left out, because they contain text: " + Join(texts, ", ") + ".");
    }
    if (!times.empty()) {
      remarks_.push_back("Left out, because their names are those of times: " +
                         Join(times, ", ") + ".");
    }
    if (IsTextFile(file_.path)) {
      return !columns_.empty() || Fail("no column has numbers of a channel");
    }
    Table table;
    if (!ReadTable(file_.path, {}, {}, &table, error_)) return false;
    for (size_t i = 0; i < table.columns.size(); ++i) {
      const std::string& name = table.columns[i];
      if (name == time_) continue;
      if (IsNameOfTime(name) &&
          IsUniformRamp(table.values.col(static_cast<Eigen::Index>(i)))) {
        continue;
      }
      columns_.push_back(name);
    }
    return true;
  }

  static Dimension DimensionOfName(const std::string& quantity) {
    return quantity == "displacement" ? Dimension::kLength
           : quantity == "velocity"   ? Dimension::kVelocity
           : quantity == "strain"     ? Dimension::kNumber
                                      : Dimension::kAcceleration;
  }

  // Finds the units of the channels. Without any the numbers are taken as they
  // are: shapes are ratios.
  bool FindUnits() {
    units_.assign(columns_.size(), "");
    std::string first;
    bool same = true;
    bool any_voltage = false;
    std::vector<std::string> without;
    for (size_t i = 0; i < columns_.size(); ++i) {
      for (const TextColumn& column : outline_.columns) {
        if (column.name == columns_[i] || column.short_name == columns_[i]) {
          units_[i] = column.unit;
        }
      }
      Dimension dimension = Dimension::kVoltage;
      if (units_[i].empty() || !FindDimension(units_[i], &dimension)) {
        units_[i].clear();
        without.push_back(columns_[i]);
        continue;
      }
      any_voltage = any_voltage || dimension == Dimension::kVoltage;
      if (dimension != Dimension::kVoltage &&
          dimension != DimensionOfName(quantities_[i])) {
        return Fail("column '" + columns_[i] + "' is in " + units_[i] +
                    ", the unit of " + DimensionName(dimension) +
                    ", but its quantity is " + quantities_[i] +
                    "; set its quantity, or leave the column out");
      }
      if (first.empty()) first = units_[i];
      same = same && units_[i] == first;
    }
    if (!same && (any_voltage || !without.empty())) {
      return Fail(
          "the units of the columns cannot be compared; write a case that "
          "gives each column its `unit`");
    }
    if (first.empty() || without.empty()) return true;
    for (std::string& unit : units_) unit = first;
    for (const std::string& name : without) {
      // "Temp (C)" is something else.
      if (name.back() != ']' && name.back() != ')') continue;
      return Fail("the unit of column '" + name +
                  "' is not known, but others have " + first +
                  "; name only columns of one kind");
    }
    remarks_.push_back("No unit is stated for " + Join(without, ", ") +
                       ": read as " + first + ", like the other columns.");
    return true;
  }

  bool FindQuantities() {
    quantities_ = file_.quantities;
    if (quantities_.empty()) quantities_ = {"acceleration"};
    if (quantities_.size() == 1)
      quantities_.resize(columns_.size(), quantities_[0]);
    if (quantities_.size() != columns_.size()) {
      return Fail(std::to_string(quantities_.size()) + " quantities for " +
                  std::to_string(columns_.size()) +
                  " columns, expected one for all or one for each");
    }
    for (std::string& quantity : quantities_) {
      // Motion of the ground is unknown here: absolute and relative
      // accelerations are treated alike.
      if (quantity == "acceleration") {
        quantity = "absolute_acceleration";
      } else if (quantity != "velocity" && quantity != "displacement" &&
                 quantity != "strain") {
        return Fail("quantity '" + quantity +
                    "', expected acceleration, velocity, displacement or "
                    "strain");
      }
    }
    return true;
  }

  const ModesDataFile& file_;
  std::vector<std::string> columns_;
  std::vector<std::string> quantities_;
  std::vector<std::string> units_;
  TextOutline outline_;  // of a text file
  std::vector<std::string> remarks_;
  std::string time_;
  std::string* error_;
};

}  // namespace

bool ReadModesDataFile(const ModesDataFile& file, ModesCase* c,
                       std::string* error) {
  return DataFileReader(file, error).Read(c);
}

bool ReadModesCase(const std::string& path, ModesCase* c, std::string* error) {
  std::string text;
  TomlValue source;
  return ReadTextFile(path, &text, error) &&
         ParseToml(text, path, &source, error) &&
         ModesCaseReader(source, path, nullptr, error).Read(c);
}

bool ReadModesOptions(const TomlValue& source, ModesCase* c,
                      std::string* error) {
  return ModesCaseReader(source, "", nullptr, error).ReadOptionsAlone(c);
}

bool ReadModesTree(const TomlValue& source, const std::string& path,
                   const CaseData& data, ModesCase* c, std::string* error) {
  return ModesCaseReader(source, path, &data, error).Read(c);
}

}  // namespace pinode
