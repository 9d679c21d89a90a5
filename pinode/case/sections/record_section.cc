#include "pinode/case/sections/record_section.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "pinode/base/strings.h"
#include "pinode/case/sections/strain_channel.h"
#include "pinode/case/text/parameter_keys.h"
#include "pinode/problem/problem_description.h"
#include "pinode/study/problem/substeps.h"

namespace pinode {
namespace {

class RecordReader {
 public:
  RecordReader(const UnitSystem& units, const StructuralModel& model,
               RecordPurpose purpose, RecordSection* section)
      : units_(units),
        model_(model),
        simulation_(purpose == RecordPurpose::kSimulation ||
                    purpose == RecordPurpose::kPlanning),
        planning_(purpose == RecordPurpose::kPlanning),
        responses_only_(purpose == RecordPurpose::kResponses),
        section_(section),
        table_(section->table) {}

  bool Read() {
    return ReadHead() && ReadTime() && ReadInputs() && ReadChannels() &&
           CheckFile() && ReadStart() && ReadFilter() && CheckAmbient();
  }

 private:
  // Returns the factor from seconds (or Hz) to the model's unit of time.
  double Second() const {
    double factor = 1.0;
    std::string error;
    return UnitFactor("s", Dimension::kTime, units_, &factor, &error) ? factor
                                                                      : 1.0;
  }

  bool ReadHead() {
    section_->name = table_.RequiredString("name");
    if (!table_.errors()->ok()) return false;
    table_.set_name("record '" + section_->name + "'");
    if (!CheckName(table_, "name", section_->name)) return false;
    section_->role =
        table_.Choice("role", {"train", "holdout"}, "train") == "holdout"
            ? IdentificationRecord::Role::kHoldout
            : IdentificationRecord::Role::kTrain;
    if (table_.Has("file")) {
      section_->file = table_.RequiredString("file");
      if (!table_.errors()->ok()) return false;
      section_->file = ResolvePath(table_, section_->file);
      if (!FileExists(table_, section_->file)) return false;
    }
    section_->substeps = table_.Integer("substeps", 0, 0, kMaxSubsteps);
    const std::string integrator = table_.Choice(
        "integrator", {"auto", "rk4", "exact", "exponential"}, "auto");
    if (integrator == "rk4") section_->integrator = Integrator::kRungeKutta;
    if (integrator == "exact") section_->integrator = Integrator::kExact;
    if (integrator == "exponential") {
      section_->integrator = Integrator::kExponential;
    }
    return table_.errors()->ok();
  }

  bool ReadTime() {
    section_->time_unit = table_.String("time_unit", "s");
    std::string error;
    if (!UnitFactor(section_->time_unit, Dimension::kTime, units_,
                    &section_->time_factor, &error)) {
      return table_.Fail("time_unit", error);
    }
    section_->time_column = table_.String("time");
    if (!ReadTextFormat(table_, &section_->text_format)) return false;
    if (table_.Has("time") && table_.Has("sampling_rate_hz")) {
      return table_.Fail(
          "time",
          "'time' and 'sampling_rate_hz' are both given, expected one of them");
    }
    if (table_.Has("sampling_rate_hz")) {
      section_->sampling_step =
          Second() / table_.PositiveNumber("sampling_rate_hz", 1.0);
    }
    if (table_.Has("resample_hz")) {
      section_->resampling_step =
          Second() / table_.PositiveNumber("resample_hz", 1.0);
    }
    if (table_.Has("window")) {
      const std::vector<double> window =
          table_.Numbers("window", 2, "end: from and to");
      if (!table_.errors()->ok()) return false;
      section_->window_from = window[0] * Second();
      section_->window_to = window[1] * Second();
    }
    if (table_.Has("duration")) {
      if (!simulation_) {
        return table_.Fail(
            "duration",
            "'duration' is for simulations without a file; use 'window'");
      }
      section_->duration = table_.PositiveNumber("duration", 1.0) * Second();
    }
    return table_.errors()->ok();
  }

  bool ReadInputs() {
    if (!ReadInputSections(table_, section_->file, units_, model_,
                           &section_->inputs)) {
      return false;
    }
    if (section_->has_excitation() &&
        !table_.RequireKey("interpolation",
                           "one of held, linear, cubic, band_limited, for the "
                           "excitation between its samples")) {
      return false;
    }
    const std::string interpolation = table_.Choice(
        "interpolation", {"held", "linear", "cubic", "band_limited"}, "linear");
    return table_.errors()->ok() &&
           ParseInterpolation(interpolation, &section_->interpolation);
  }

  // Reads `dof` or `combination`.
  bool ReadWeights(const TomlTable& table, ChannelSection* channel) {
    if (responses_only_ && !table.Has("dof") && !table.Has("combination")) {
      channel->location = channel->name;
      channel->weights =
          Vector::Unit(model_.num_dofs(), model_.DofIndex(channel->name));
      return true;
    }
    if (table.Has("dof") == table.Has("combination")) {
      return table.Fail("dof",
                        "expected one of dof = \"...\" and combination "
                        "= {dof = weight, ...}");
    }
    channel->weights = Vector::Zero(model_.num_dofs());
    int dof = -1;
    if (table.Has("dof")) {
      channel->location = table.String("dof");
      if (!table.errors()->ok() ||
          !FindDof(model_, table, "dof", channel->location, false, &dof)) {
        return false;
      }
      channel->weights[dof] = 1.0;
      return true;
    }
    const TomlTable combination =
        table.Table("combination", table.name() + ", combination");
    if (!table.errors()->ok()) return false;
    std::vector<std::string> parts;
    for (const auto& [name, value] : combination.entries()) {
      if (!FindDof(model_, combination, name, name, false, &dof)) return false;
      const double weight = combination.Number(name, 0.0);
      channel->weights[dof] = weight;
      parts.push_back(FormatNumber(weight, 6) + " " + name);
    }
    if (!table.errors()->ok()) return false;
    if (channel->weights.isZero(0.0)) {
      return table.Fail("combination",
                        "'combination' has no weight other than zero, expected "
                        "{dof = weight, ...}");
    }
    channel->location = Join(parts, " + ");
    return true;
  }

  bool ReadChannels() {
    std::set<std::string> seen;
    for (TomlTable& table : table_.Tables("channel", "record")) {
      if (!table.AllowKeys()) {
        return false;
      }
      ChannelSection channel(table);
      channel.name = table.String("name", table.String("column"));
      if (!table.errors()->ok()) return false;
      if (channel.name.empty()) {
        const std::string key = table.Has("name") ? "name" : "column";
        return table.RequireKey(key, "a column") &&
               table.Fail(key, "'" + key + "' is empty, expected a text");
      }
      table.set_name(table_.name() + ", channel '" + channel.name + "'");
      channel.signal.table.set_name(table.name());
      channel.signal.label = "channel " + channel.name;
      if (!seen.insert(channel.name).second) {
        return table.Fail(
            table.Has("name") ? "name" : "column",
            "this name is used twice in this record, expected different names");
      }
      std::string error;
      const std::string quantity = table.RequiredString("quantity");
      if (!table.errors()->ok()) return false;
      if (!ParseQuantity(quantity, &channel.quantity, &error)) {
        return table.Fail("quantity", error);
      }
      if (!ReadWeights(table, &channel) || !ReadStrainKeys(table, &channel)) {
        return false;
      }
      channel.signal.dimension = DimensionOf(channel.quantity);
      // The weights of a combination may have a unit, as in a strain.
      if (table.Has("combination") && table.String("unit") == "1") {
        channel.signal.dimension = Dimension::kNumber;
      }
      if (IsVoltage(table)) channel.signal.dimension = Dimension::kVoltage;
      channel.signal.sign = 1;
      if (table.Has("sign")) {
        const double sign = table.Number("sign", 1.0);
        if (!table.errors()->ok()) return false;
        if (sign != 1.0 && sign != -1.0) {
          return table.Fail(
              "sign", "'sign' is " + FormatNumber(sign) + ", expected 1 or -1");
        }
        channel.signal.sign = sign < 0.0 ? -1 : 1;
      }
      channel.signal.scale = table.Number("scale", 1.0);
      if (!table.errors()->ok()) return false;
      if (channel.signal.scale == 0.0) {
        return table.Fail("scale",
                          "'scale' is 0, expected the factor from the "
                          "column's numbers to its unit");
      }
      channel.fit = table.Boolean("fit", true);
      if ((!simulation_ && !ReadSource(section_->file, &channel.signal)) ||
          !ReadUnit(units_, table_, &channel.signal)) {
        return false;
      }
      section_->channels.push_back(std::move(channel));
    }
    if (table_.errors()->ok() && section_->channels.empty() && !planning_) {
      return table_.Fail("channel",
                         "it has no [[record.channel]], expected "
                         "at least one measured response");
    }
    return table_.errors()->ok();
  }

  bool CheckFile() {
    std::vector<std::string> files;
    if (!section_->file.empty()) files.push_back(section_->file);
    for (const InputSection& input : section_->inputs) {
      if (!input.value.has_value()) files.push_back(input.signal.file);
    }
    for (const ChannelSection& channel : section_->channels) {
      if (!simulation_) files.push_back(channel.signal.file);
    }
    if (files.empty()) {
      if (section_->duration > 0.0 && section_->sampling_step > 0.0) {
        return true;
      }
      return table_.Fail("file",
                         "'file' is missing, expected one, or "
                         "'sampling_rate_hz' and 'duration'");
    }
    if (section_->duration > 0.0) {
      return table_.Fail("duration",
                         "'duration' and a file are both given; use 'window'");
    }
    if (section_->file.empty()) section_->file = files[0];
    const bool any_table =
        std::any_of(files.begin(), files.end(),
                    [](const std::string& path) { return !IsAt2File(path); });
    if (any_table && section_->time_column.empty() &&
        section_->sampling_step == 0.0) {
      return table_.Fail("time",
                         "'time' is missing, expected the column of "
                         "the time, or 'sampling_rate_hz'");
    }
    return true;
  }

  bool ReadStart() {
    section_->periodic = table_.Boolean("periodic", false);
    if (section_->periodic) {
      for (const char* key : {"start", "start_samples"}) {
        if (!table_.Has(key)) continue;
        return table_.Fail(key,
                           "a record with periodic = true is in its steady "
                           "state, expected no '" +
                               std::string(key) + "'");
      }
    }
    const TomlValue* start = table_.Find("start");
    if (start == nullptr || !start->IsTable()) {
      const std::string name = table_.Choice("start", {"rest", "free"}, "free");
      section_->start = name == "rest" ? IdentificationRecord::Start::kRest
                                       : IdentificationRecord::Start::kFree;
      return ReadStartSamples(table_, "start_samples");
    }
    const TomlTable known = table_.Table("start", table_.name() + ", start");
    if (known.Has("from")) {
      section_->start = IdentificationRecord::Start::kFree;
      known.Choice("from", {"first"}, "first");
      return known.AllowKeys({"from", "samples"}) &&
             known.RequireKey("samples", "the number of first samples") &&
             ReadStartSamples(known, "samples");
    }
    if (!known.AllowKeys({"x", "v"})) return false;
    const int n = model_.num_dofs();
    section_->start = IdentificationRecord::Start::kKnown;
    section_->start_x = Vector::Zero(n);
    section_->start_v = Vector::Zero(n);
    for (const char* key : {"x", "v"}) {
      if (!known.Has(key)) continue;
      const std::vector<double> values = known.Numbers(key, n, "DOF");
      if (!table_.errors()->ok()) return false;
      (key[0] == 'x' ? section_->start_x : section_->start_v) =
          ToVector(values);
    }
    return true;
  }

  // Reads the samples of a hold-out that determine its start.
  bool ReadStartSamples(const TomlTable& table, const char* key) {
    if (!table.Has(key)) return table_.errors()->ok();
    if (section_->start != IdentificationRecord::Start::kFree) {
      return table.Fail(key,
                        std::string("'") + key + "' needs start = \"free\"");
    }
    section_->start_samples = table.LongInteger(key, 0, 1);
    return table_.errors()->ok();
  }

  bool ReadFilter() {
    if (!table_.Has("filter")) return true;
    const TomlTable table = table_.Table("filter", table_.name() + ", filter");
    if (!table_.errors()->ok() || !table.AllowKeys()) {
      return false;
    }
    if (!table.RequireKey("type", "one of lowpass, highpass, bandpass") ||
        !table.RequireKey("corner_hz", "a frequency, or two for bandpass")) {
      return false;
    }
    FilterOptions filter;
    const std::string type =
        table.Choice("type", {"lowpass", "highpass", "bandpass"}, "lowpass");
    filter.type = type == "lowpass"    ? FilterType::kLowPass
                  : type == "highpass" ? FilterType::kHighPass
                                       : FilterType::kBandPass;
    if (table.Find("corner_hz")->IsNumber()) {
      filter.corner_frequencies = {table.Number("corner_hz", 1.0)};
    } else {
      filter.corner_frequencies = table.Numbers("corner_hz");
    }
    for (double& corner : filter.corner_frequencies) corner /= Second();
    filter.order = table.Integer("order", filter.order, 1, 1000);
    section_->filter = filter;
    return table_.errors()->ok();
  }

  // Checks a record of unmeasured loads. It has no start; measured forces and
  // ground motions may act as well.
  bool CheckAmbient() {
    const std::string excitation = table_.Choice(
        "excitation", {"measured", "ambient", "none"}, "measured");
    section_->ambient = excitation == "ambient";
    section_->free_decay = excitation == "none";
    if (!table_.errors()->ok()) return false;
    for (const char* key : {"ground", "force", "motion"}) {
      if (!section_->free_decay || !table_.Has(key)) continue;
      return table_.Fail(key, std::string("'") + key +
                                  "' in a record with excitation = \"none\", "
                                  "expected only responses");
    }
    if (!section_->ambient) {
      return !table_.Has("ambient") ||
             table_.Fail("ambient", "'ambient' needs excitation = \"ambient\"");
    }
    if (simulation_) {
      return table_.Fail("excitation",
                         std::string("unmeasured loads cannot be ") +
                             (planning_ ? "planned for" : "simulated") +
                             ", expected measured ones");
    }
    for (const char* key : {"motion", "start", "start_samples", "substeps",
                            "integrator", "periodic"}) {
      if (!table_.Has(key)) continue;
      return table_.Fail(key, std::string("'") + key +
                                  "' has no meaning in a record with "
                                  "excitation = \"ambient\"");
    }
    for (const InputSection& input : section_->inputs) {
      if (input.spec.kind == InputSpec::Kind::kCovariate) continue;
      const TomlTable& table = input.signal.table;
      for (const char* key : {"sigma", "sigma_percent"}) {
        if (!table.Has(key)) continue;
        return table.Fail(
            key, std::string("'") + key +
                     "' of a measured load in a record with unmeasured loads, "
                     "expected none: they include its noise");
      }
      const TomlValue* scale = table.Find("scale");
      if (IsVoltage(table) && scale == nullptr) {
        return table.Fail("unit",
                          "a load in volts with excitation = \"ambient\" needs "
                          "a number for 'scale'");
      }
      if (scale == nullptr || !scale->IsTable()) continue;
      return table.Fail("scale",
                        "'scale' cannot be unknown with excitation = "
                        "\"ambient\", expected a number");
    }
    return CheckAmbientChannels();
  }

  // Notes the gain of a channel, which must be known: the size of unmeasured
  // loads is found, so a free gain has nothing to compare itself with.
  bool ReadKnownGain(ChannelSection* channel) {
    const TomlTable& table = channel->signal.table;
    if (!table.Has("gain")) return true;
    const TomlTable keys = table.Table("gain", table.name() + ", gain");
    if (!table.errors()->ok() || !keys.AllowKeys()) return false;
    for (const char* key :
         {"free", "lower", "upper", "prior_mean", "prior_sigma"}) {
      const bool is_false = std::string(key) == "free" && keys.Has(key) &&
                            !keys.Boolean(key, false);
      if (!keys.Has(key) || is_false) continue;
      return table.Fail("gain",
                        "an unknown gain cannot be told apart from unmeasured "
                        "loads; expected gain = {initial = ...} alone");
    }
    // A sensitivity in volts has no default.
    if (IsVoltage(table) &&
        !keys.RequireKey("initial",
                         "the nominal sensitivity, in volts per the model's "
                         "unit")) {
      return false;
    }
    const double gain = keys.Number("initial", 1.0);
    if (!table.errors()->ok()) return false;
    if (gain == 0.0) {
      return table.Fail("gain", "the gain is 0, expected the sensor's");
    }
    channel->known_gain = gain;
    return true;
  }

  bool CheckAmbientChannels() {
    for (ChannelSection& channel : section_->channels) {
      const TomlTable& table = channel.signal.table;
      if (!ReadKnownGain(&channel)) return false;
      for (const char* key : {"offset", "delay"}) {
        if (!table.Has(key)) continue;
        return table.Fail(
            key,
            std::string("'") + key +
                "' cannot be told apart from unmeasured loads; leave it out");
      }
      // For modes alone the scale and noise of a channel have no effect.
      if (responses_only_) continue;
      if (IsVoltage(table) && !table.Has("gain")) {
        return table.Fail(
            "unit",
            "a channel in volts needs a known sensitivity with excitation = "
            "\"ambient\", expected gain = {initial = ...} in volts per the "
            "model's unit");
      }
      for (const char* key : {"fit", "sigma", "sigma_percent"}) {
        if (!table.Has(key)) continue;
        return table.Fail(key, std::string("'") + key +
                                   "' of a channel in a record with "
                                   "excitation = \"ambient\", expected none: "
                                   "its noise is found, and it is fitted");
      }
    }
    if (responses_only_) return true;
    if (section_->role == IdentificationRecord::Role::kHoldout) {
      return table_.Fail("role",
                         "a record with excitation = \"ambient\" cannot be "
                         "predicted, expected role = \"train\"");
    }
    return section_->has_excitation() || !table_.Has("interpolation") ||
           table_.Fail("interpolation",
                       "'interpolation' has no meaning in a record with "
                       "excitation = \"ambient\" and no measured load");
  }

  const UnitSystem& units_;
  const StructuralModel& model_;
  const bool simulation_;
  const bool planning_;
  const bool responses_only_;
  RecordSection* section_;
  TomlTable& table_;
};

}  // namespace

bool RecordSection::has_excitation() const {
  return std::any_of(inputs.begin(), inputs.end(),
                     [](const InputSection& input) {
                       return input.spec.kind != InputSpec::Kind::kCovariate;
                     });
}

bool ReadRecordSections(const TomlTable& root, const UnitSystem& units,
                        const StructuralModel& model, RecordPurpose purpose,
                        std::vector<RecordSection>* sections) {
  // Measured modes need no record, and neither does a model that is only
  // checked; these cannot be simulated. IdentificationProblem::IsValid checks
  // the requirements of a fit.
  if (purpose != RecordPurpose::kFit &&
      !root.RequireKey("record", "at least one [[record]]")) {
    return false;
  }
  std::set<std::string> seen;
  for (const TomlTable& table : root.Tables("record")) {
    if (!table.AllowKeys()) return false;
    RecordSection section(table);
    if (!RecordReader(units, model, purpose, &section).Read()) return false;
    if (!seen.insert(section.name).second) {
      return section.table.Fail(
          "name", "this name is used twice, expected different names");
    }
    sections->push_back(std::move(section));
  }
  return root.errors()->ok();
}

std::vector<InputSpec> CollectInputs(const std::vector<RecordSection>& sections,
                                     const StructuralModel& model) {
  std::vector<InputSpec> inputs;
  const auto add = [&inputs](const InputSpec& spec) {
    for (const InputSpec& other : inputs) {
      if (other.name == spec.name) return;
    }
    inputs.push_back(spec);
  };
  bool absolute_displacement = false;
  for (const RecordSection& section : sections) {
    for (const InputSection& input : section.inputs) {
      add(input.spec);
      if (input.spec.kind != InputSpec::Kind::kPrescribedDisplacement) continue;
      for (const int derivative : {1, 2}) {
        add(PrescribedInput(model, input.spec.index, derivative));
      }
    }
    for (const ChannelSection& channel : section.channels) {
      absolute_displacement =
          absolute_displacement ||
          channel.quantity == Quantity::kAbsoluteDisplacement;
    }
  }
  if (!absolute_displacement) return inputs;
  const std::vector<InputSpec> measured = inputs;
  for (const InputSpec& input : measured) {
    if (input.kind != InputSpec::Kind::kGroundAcceleration) continue;
    add({InputSpec::Kind::kGroundDisplacement, input.index,
         "ground_displacement_" +
             model.directions[static_cast<size_t>(input.index)]});
  }
  return inputs;
}

}  // namespace pinode
