#include "pinode/case/sections/sensors_section.h"

#include <map>
#include <string>

#include "pinode/case/text/parameter_keys.h"

namespace pinode {
namespace {

bool Same(const Parameter& a, const Parameter& b) {
  return a.value == b.value && a.lower == b.lower && a.upper == b.upper &&
         a.prior_mean == b.prior_mean && a.prior_sigma == b.prior_sigma &&
         a.free == b.free && a.tie == b.tie && a.tie_factor == b.tie_factor;
}

std::string VoltsPer(const std::string& unit) {
  if (unit == "1") return "V";
  return unit.find('/') == std::string::npos ? "V/" + unit : "V/(" + unit + ")";
}

class SensorsReader {
 public:
  SensorsReader(const UnitSystem& units, IdentificationProblem* problem)
      : units_(units), problem_(problem) {}

  bool Read(const std::vector<RecordSection>& sections) {
    problem_->sensors.name = "sensors";
    for (size_t r = 0; r < sections.size(); ++r) {
      for (size_t c = 0; c < sections[r].channels.size(); ++c) {
        const ChannelSection& channel = sections[r].channels[c];
        double second = 1.0;
        std::string error;
        if (!UnitFactor("s", Dimension::kTime, units_, &second, &error)) {
          return channel.signal.table.Fail("delay", error);
        }
        Parameter gain;
        gain.name = "gain." + channel.name;
        gain.value = 1.0;
        if (channel.signal.dimension == Dimension::kVoltage) {
          gain.unit = VoltsPer(UnitName(DimensionOf(channel.quantity), units_));
        }
        Parameter delay;
        delay.name = "delay." + channel.name;
        delay.unit = UnitName(Dimension::kTime, units_);
        Parameter offset;
        offset.name =
            "offset." +
            (IsShared(channel, "offset") ? "" : sections[r].name + ".") +
            channel.name;
        offset.unit = UnitName(channel.signal.dimension, units_);
        int unused = -1;
        // A record of unmeasured loads was divided by its known gains.
        if ((!sections[r].ambient &&
             !ReadOne(channel, "gain", 1.0, gain, &unused)) ||
            !ReadOne(channel, "delay", second, delay, &unused) ||
            !ReadOne(channel, "offset", channel.signal.factor, offset,
                     &problem_->records[r].channels[c].offset)) {
          return false;
        }
      }
    }
    if (!CheckVoltages(sections)) return false;
    for (IdentificationRecord& record : problem_->records) {
      for (MeasuredChannel& channel : record.channels) {
        channel.gain = Index("gain." + channel.observation.name);
        channel.delay = Index("delay." + channel.observation.name);
        if (channel.offset < 0) {
          channel.offset = Index("offset." + channel.observation.name);
        }
      }
    }
    ShareOffsets();
    return true;
  }

 private:
  // Checks that channels in volts have a gain, and that a gain is not used for
  // volts and other units together.
  bool CheckVoltages(const std::vector<RecordSection>& sections) const {
    for (const RecordSection& section : sections) {
      if (section.ambient) continue;
      for (const ChannelSection& channel : section.channels) {
        const int index = Index("gain." + channel.name);
        const bool in_volts = channel.signal.dimension == Dimension::kVoltage;
        const bool gain_in_volts =
            index >= 0 &&
            problem_->sensors.parameters[static_cast<size_t>(index)].unit !=
                "1";
        if (in_volts == gain_in_volts) continue;
        return channel.signal.table.Fail(
            "unit",
            in_volts && index < 0
                ? "a channel in volts needs its sensitivity, expected gain = "
                  "{initial = ...} in volts per the model's unit"
                : "it is in volts in one record but not in another with the "
                  "same gain; give the channel another name there");
      }
    }
    return true;
  }

  static bool IsShared(const ChannelSection& channel, const char* key) {
    const TomlTable& table = channel.signal.table;
    return table.Has(key) &&
           table.Table(key, table.name() + ", " + key).Boolean("shared", false);
  }

  // Shares the sensors of training records with hold-outs, including offsets:
  // those of the last training record before it, or else of the first.
  void ShareOffsets() {
    std::map<std::string, int> offsets = FirstOffsets();
    for (IdentificationRecord& record : problem_->records) {
      const bool train = record.role == IdentificationRecord::Role::kTrain;
      for (MeasuredChannel& channel : record.channels) {
        const std::string& name = channel.observation.name;
        if (train && channel.offset >= 0) offsets[name] = channel.offset;
        if (train || channel.offset >= 0 || offsets.count(name) == 0) continue;
        channel.offset = offsets[name];
        record.description.remarks.push_back(
            "channel " + name + ": its offset is '" +
            problem_->sensors.parameters[static_cast<size_t>(channel.offset)]
                .name +
            "', as of the same sensor.");
      }
    }
  }

  // Returns by channel the offset of the first training record that has one.
  std::map<std::string, int> FirstOffsets() const {
    std::map<std::string, int> offsets;
    for (const IdentificationRecord& record : problem_->records) {
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      for (const MeasuredChannel& channel : record.channels) {
        if (channel.offset >= 0) {
          offsets.emplace(channel.observation.name, channel.offset);
        }
      }
    }
    return offsets;
  }

  bool ReadOne(const ChannelSection& channel, const char* key, double factor,
               Parameter parameter, int* index) {
    const TomlTable& table = channel.signal.table;
    if (!table.Has(key)) return true;
    const TomlTable keys = table.Table(key, table.name() + ", " + key);
    if (!table.errors()->ok() || !keys.AllowKeys()) return false;
    if (std::string(key) == "gain" && parameter.unit != "1" &&
        !keys.RequireKey("initial",
                         "the nominal sensitivity, in " + parameter.unit)) {
      return false;
    }
    parameter.free = false;
    parameter.prior_mean = parameter.value;
    if (!ReadParameterKeys(keys, factor, &parameter)) return false;
    const auto known = indices_.find(parameter.name);
    if (known != indices_.end()) {
      *index = known->second;
      const Parameter& first =
          problem_->sensors.parameters[static_cast<size_t>(*index)];
      return Same(first, parameter) ||
             table.Fail(key, std::string("'") + key +
                                 "' differs from that of the same channel in "
                                 "another record, expected the same");
    }
    *index = problem_->sensors.size();
    indices_[parameter.name] = *index;
    problem_->sensors.parameters.push_back(std::move(parameter));
    return true;
  }

  int Index(const std::string& name) const {
    const auto found = indices_.find(name);
    return found == indices_.end() ? -1 : found->second;
  }

  const UnitSystem& units_;
  IdentificationProblem* problem_;
  std::map<std::string, int> indices_;
};

}  // namespace

bool ReadSensors(const std::vector<RecordSection>& sections,
                 const UnitSystem& units, IdentificationProblem* problem) {
  return SensorsReader(units, problem).Read(sections);
}

}  // namespace pinode
