#include "pinode/case/sections/force_scale_section.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "pinode/case/sections/unknown_force_section.h"
#include "pinode/case/text/parameter_keys.h"

namespace pinode {
namespace {

const TomlValue* ScaleOf(const InputSection& input) {
  return input.spec.kind == InputSpec::Kind::kForce
             ? input.signal.table.Find("scale")
             : nullptr;
}

// Names of the unknown scales of the forces, by record and place in it; empty:
// the scale is known.
class ForceScales {
 public:
  explicit ForceScales(const std::vector<RecordSection>& sections)
      : sections_(sections) {
    for (const RecordSection& section : sections) {
      for (const InputSection& input : section.inputs) {
        if (IsGiven(input)) given_.insert(GivenName(input));
      }
    }
  }

  std::string NameOf(const InputSection& input) const {
    if (IsGiven(input)) return GivenName(input);
    const std::string own = "scale." + input.spec.name;
    return input.spec.kind == InputSpec::Kind::kForce &&
                   ScaleOf(input) == nullptr && given_.count(own) != 0
               ? own
               : "";
  }

  // True if a force has the same scale in all records.
  bool IsUniform(const std::string& input_name) const {
    std::set<std::string> names;
    for (const RecordSection& section : sections_) {
      for (const InputSection& input : section.inputs) {
        if (input.spec.name == input_name) names.insert(NameOf(input));
      }
    }
    return names.size() == 1;
  }

  static bool IsGiven(const InputSection& input) {
    const TomlValue* scale = ScaleOf(input);
    return scale != nullptr && scale->IsTable();
  }

 private:
  static std::string GivenName(const InputSection& input) {
    const TomlValue* name = ScaleOf(input)->Find("name");
    return "scale." + (name != nullptr ? name->text : input.spec.name);
  }

  const std::vector<RecordSection>& sections_;
  std::set<std::string> given_;
};

int InputIndex(const std::vector<InputSpec>& inputs, const std::string& name) {
  const auto found =
      std::find_if(inputs.begin(), inputs.end(),
                   [&](const InputSpec& spec) { return spec.name == name; });
  return found == inputs.end() ? -1 : static_cast<int>(found - inputs.begin());
}

bool SameScale(const Parameter& a, const Parameter& b) {
  return a.unit == b.unit && a.value == b.value && a.lower == b.lower &&
         a.upper == b.upper && a.prior_mean == b.prior_mean &&
         a.prior_sigma == b.prior_sigma && a.free == b.free && a.tie == b.tie &&
         a.tie_factor == b.tie_factor;
}

class ForceScalesReader {
 public:
  ForceScalesReader(const std::vector<RecordSection>& sections,
                    const TermsContext& context, StructuralDynamics* dynamics)
      : sections_(sections),
        scales_(sections),
        units_(*context.units),
        remarks_(context.remarks),
        dynamics_(dynamics) {}

  bool Read() {
    for (const RecordSection& section : sections_) {
      for (const InputSection& input : section.inputs) {
        if (ForceScales::IsGiven(input) && !ReadScale(input)) return false;
      }
    }
    for (const RecordSection& section : sections_) {
      for (const InputSection& input : section.inputs) {
        if (!AddForce(section, input)) return false;
      }
    }
    for (ForceScaleTerm& term : terms_) {
      std::string error;
      if (!dynamics_->AddForceScale(term, &error)) {
        return tables_.at(term.name).Fail("scale", error);
      }
    }
    return true;
  }

 private:
  std::string UnitOf(const InputSection& input) const {
    return input.signal.dimension == Dimension::kVoltage
               ? units_.force + "/" + UnitName(Dimension::kVoltage, units_)
               : "1";
  }

  bool ReadScale(const InputSection& input) {
    const TomlTable& table = input.signal.table;
    const TomlTable keys = table.Table("scale", table.name() + ", scale");
    if (!table.errors()->ok() || !keys.AllowKeys()) return false;
    if (keys.Has("name")) {
      const std::string name = keys.RequiredString("name");
      if (!table.errors()->ok() || !CheckName(keys, "name", name)) return false;
    }
    Parameter scale;
    scale.name = scales_.NameOf(input);
    scale.unit = UnitOf(input);
    scale.value = 1.0;
    if (scale.unit != "1" &&
        !keys.RequireKey("initial",
                         "the nominal sensitivity, in " + scale.unit)) {
      return false;
    }
    if (!ReadParameterKeys(keys, 1.0, &scale)) return false;
    const auto known_term = std::find_if(
        terms_.begin(), terms_.end(),
        [&](const ForceScaleTerm& term) { return term.name == scale.name; });
    if (known_term != terms_.end()) {
      return SameScale(known_term->parameters.parameters[0], scale) ||
             table.Fail("scale",
                        "'scale' differs from that of '" + scale.name +
                            "' in another place, expected the same keys and "
                            "kind of unit, or another 'name'");
    }
    ForceScaleTerm term;
    term.name = scale.name;
    term.parameters.name = scale.name;
    tables_.emplace(scale.name, table);
    term.parameters.parameters.push_back(std::move(scale));
    terms_.push_back(std::move(term));
    return true;
  }

  // Adds the force of one record to those that its scale multiplies.
  bool AddForce(const RecordSection& section, const InputSection& input) {
    const std::string name = scales_.NameOf(input);
    const auto term = std::find_if(
        terms_.begin(), terms_.end(),
        [&](const ForceScaleTerm& other) { return other.name == name; });
    if (term == terms_.end()) {
      return input.spec.kind != InputSpec::Kind::kForce ||
             input.signal.dimension != Dimension::kVoltage ||
             input.signal.table.RequireKey(
                 "scale",
                 "the sensitivity of a force in volts, in " + UnitOf(input));
    }
    if (term->parameters.parameters[0].unit != UnitOf(input)) {
      return input.signal.table.Fail(
          "unit", "its scale, '" + name + "', is in " +
                      term->parameters.parameters[0].unit +
                      ", expected the same kind of unit as elsewhere, or "
                      "another 'name' of the scale");
    }
    if (!ForceScales::IsGiven(input)) {
      remarks_->push_back("Record " + section.name + ": the scale of " +
                          input.signal.label + " is '" + name +
                          "', the same as in other records.");
    }
    ForceScaleTerm::Force force;
    force.input = InputIndex(dynamics_->inputs(), input.spec.name);
    if (!scales_.IsUniform(input.spec.name)) {
      force.record_switch =
          InputIndex(dynamics_->inputs(), RecordSwitchName(section.name));
    }
    const bool there =
        std::any_of(term->forces.begin(), term->forces.end(),
                    [&](const ForceScaleTerm::Force& other) {
                      return other.input == force.input &&
                             other.record_switch == force.record_switch;
                    });
    if (!there) term->forces.push_back(force);
    return true;
  }

  const std::vector<RecordSection>& sections_;
  const ForceScales scales_;
  const UnitSystem& units_;
  std::vector<std::string>* remarks_;
  StructuralDynamics* dynamics_;
  std::vector<ForceScaleTerm> terms_;
  std::map<std::string, TomlTable> tables_;  // where each is given first
};

}  // namespace

std::string ForceScaleName(const TomlValue& force) {
  const TomlValue* scale = force.Find("scale");
  if (scale == nullptr || !scale->IsTable()) return "";
  const TomlValue* name = scale->Find("name");
  return name != nullptr ? "scale." + name->text
                         : "scale.force_" + force.Find("dof")->text;
}

void AddScaleSwitches(const std::vector<RecordSection>& sections,
                      std::vector<InputSpec>* inputs) {
  const ForceScales scales(sections);
  for (size_t r = 0; r < sections.size(); ++r) {
    for (const InputSection& input : sections[r].inputs) {
      const std::string name = RecordSwitchName(sections[r].name);
      if (scales.NameOf(input).empty() || scales.IsUniform(input.spec.name) ||
          InputIndex(*inputs, name) >= 0) {
        continue;
      }
      inputs->push_back(
          {InputSpec::Kind::kRecordSwitch, static_cast<int>(r), name});
    }
  }
}

bool ReadForceScales(const std::vector<RecordSection>& sections,
                     const TermsContext& context,
                     StructuralDynamics* dynamics) {
  return ForceScalesReader(sections, context, dynamics).Read();
}

}  // namespace pinode
