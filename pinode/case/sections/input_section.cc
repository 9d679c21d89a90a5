#include "pinode/case/sections/input_section.h"

#include <algorithm>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/case/sections/model_section.h"

namespace pinode {
namespace {

class InputReader {
 public:
  InputReader(const TomlTable& table, const std::string& file,
              const UnitSystem& units, const StructuralModel& model,
              std::vector<InputSection>* inputs)
      : table_(table),
        file_(file),
        units_(units),
        model_(model),
        inputs_(inputs) {}

  bool Read() {
    return ReadGrounds() && ReadForces() && ReadMotions() && ReadCovariates();
  }

 private:
  bool AddInput(InputSection input) {
    for (const InputSection& other : *inputs_) {
      if (other.spec.name != input.spec.name) continue;
      return input.signal.table.Fail(
          "column", "'" + input.signal.label +
                        "' is given twice in this record, expected once");
    }
    inputs_->push_back(std::move(input));
    return true;
  }

  // Adds an input with the place and unit of its values.
  bool AddMeasured(InputSection input) {
    return ReadSource(file_, &input.signal) &&
           ReadUnit(units_, table_, &input.signal) &&
           AddInput(std::move(input));
  }

  bool ReadGrounds() {
    for (TomlTable& table : table_.Tables("ground", "record")) {
      table.set_name(table_.name() + ", ground");
      if (!table.AllowKeys()) {
        return false;
      }
      InputSection input(table);
      const std::string direction = table.RequiredString("direction");
      if (!table.errors()->ok()) return false;
      input.spec.kind = InputSpec::Kind::kGroundAcceleration;
      input.spec.index = model_.DirectionIndex(direction);
      if (input.spec.index < 0) {
        return table.Fail("direction",
                          "'" + direction +
                              "' is not a direction of the model's influence "
                              "vectors" +
                              NameHint(direction, model_.directions));
      }
      if (table.Has("scale") && table.Find("scale")->IsTable()) {
        return table.Fail(
            "scale",
            "'scale' of a ground motion cannot be unknown, expected a number; "
            "gains of channels can be unknown");
      }
      input.spec.name = "ground_" + direction;
      input.signal.label = "ground " + direction;
      input.signal.dimension = Dimension::kAcceleration;
      input.signal.scale = table.Number("scale", 1.0);
      if (!AddMeasured(std::move(input))) return false;
    }
    return true;
  }

  bool ReadForces() {
    for (TomlTable& table : table_.Tables("force", "record")) {
      table.set_name(table_.name() + ", force");
      if (!table.AllowKeys()) {
        return false;
      }
      InputSection input(table);
      const std::string dof = table.RequiredString("dof");
      if (!table.errors()->ok() ||
          !FindDof(model_, table, "dof", dof, false, &input.spec.index)) {
        return false;
      }
      input.spec.kind = InputSpec::Kind::kForce;
      input.spec.name = "force_" + dof;
      input.signal.label = "force " + dof;
      input.signal.dimension =
          IsVoltage(table) ? Dimension::kVoltage : Dimension::kForce;
      // An unknown scale is a parameter of the model.
      const bool unknown = table.Has("scale") && table.Find("scale")->IsTable();
      input.signal.scale = unknown ? 1.0 : table.Number("scale", 1.0);
      if (!AddMeasured(std::move(input))) return false;
    }
    return true;
  }

  // Reads prescribed motions of an actuator: a displacement and, if measured,
  // its derivatives.
  bool ReadMotions() {
    for (TomlTable& table : table_.Tables("motion", "record")) {
      table.set_name(table_.name() + ", motion");
      if (!table.AllowKeys()) {
        return false;
      }
      InputSection input(table);
      const std::string dof = table.RequiredString("dof");
      const std::string quantity =
          table.Choice("quantity", {"displacement", "velocity", "acceleration"},
                       "displacement");
      if (!table.errors()->ok() ||
          !FindDof(model_, table, "dof", dof, false, &input.spec.index)) {
        return false;
      }
      const int derivative = quantity == "displacement" ? 0
                             : quantity == "velocity"   ? 1
                                                        : 2;
      input.spec = PrescribedInput(model_, input.spec.index, derivative);
      input.signal.label = "prescribed " + quantity + " " + dof;
      input.signal.dimension = derivative == 0   ? Dimension::kLength
                               : derivative == 1 ? Dimension::kVelocity
                                                 : Dimension::kAcceleration;
      input.signal.scale = table.Number("scale", 1.0);
      if (!AddMeasured(std::move(input))) return false;
    }
    for (const InputSection& input : *inputs_) {
      if (input.spec.kind != InputSpec::Kind::kPrescribedVelocity &&
          input.spec.kind != InputSpec::Kind::kPrescribedAcceleration) {
        continue;
      }
      const InputSpec needed = PrescribedInput(model_, input.spec.index, 0);
      if (std::none_of(inputs_->begin(), inputs_->end(),
                       [&needed](const InputSection& other) {
                         return other.spec.name == needed.name;
                       })) {
        return input.signal.table.Fail(
            "quantity", "'" + input.signal.label +
                            "' is given without the displacement, expected a "
                            "[[record.motion]] of it as well");
      }
    }
    return table_.errors()->ok();
  }

  bool ReadCovariates() {
    for (TomlTable& table : table_.Tables("covariate", "record")) {
      table.set_name(table_.name() + ", covariate");
      if (!table.AllowKeys()) return false;
      InputSection input(table);
      input.spec.kind = InputSpec::Kind::kCovariate;
      input.spec.name = table.RequiredString("name");
      if (!table.errors()->ok()) return false;
      if (input.spec.name.rfind("ground_", 0) == 0 ||
          input.spec.name.rfind("force_", 0) == 0 ||
          input.spec.name.rfind("motion_", 0) == 0) {
        return table.Fail(
            "name",
            "'" + input.spec.name +
                "' begins like the name of an excitation; give another name");
      }
      input.signal.label = "covariate " + input.spec.name;
      if (table.Has("value")) {
        for (const char* key : {"column", "file"}) {
          if (!table.Has(key)) continue;
          return table.Fail("value",
                            "'value' and '" + std::string(key) +
                                "' are both given, expected one of them");
        }
        input.value = table.Number("value", 0.0);
        if (!table.errors()->ok()) return false;
      } else if (!ReadSource(file_, &input.signal)) {
        return false;
      }
      if (!AddInput(std::move(input))) return false;
    }
    return true;
  }

  const TomlTable& table_;
  const std::string& file_;
  const UnitSystem& units_;
  const StructuralModel& model_;
  std::vector<InputSection>* inputs_;
};

}  // namespace

InputSpec PrescribedInput(const StructuralModel& model, int dof,
                          int derivative) {
  const std::string& name = model.dof_names[static_cast<size_t>(dof)];
  switch (derivative) {
    case 0:
      return {InputSpec::Kind::kPrescribedDisplacement, dof, "motion_" + name};
    case 1:
      return {InputSpec::Kind::kPrescribedVelocity, dof,
              "motion_velocity_" + name};
    default:
      return {InputSpec::Kind::kPrescribedAcceleration, dof,
              "motion_acceleration_" + name};
  }
}

bool ReadInputSections(const TomlTable& record, const std::string& record_file,
                       const UnitSystem& units, const StructuralModel& model,
                       std::vector<InputSection>* inputs) {
  return InputReader(record, record_file, units, model, inputs).Read();
}

}  // namespace pinode
