#include "pinode/base/units.h"

#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"

namespace pinode {
namespace {

struct Unit {
  std::string name;
  Dimension dimension;
  double in_si;
  // False for units of measured columns that no model is in.
  bool in_models = true;
};

// Standard gravity (m/s^2), exact by the definition of 1901; the g of ground
// motion records.
constexpr double kStandardGravity = 9.80665;
// Pound-force (N), exact: 0.45359237 kg times standard gravity.
constexpr double kPoundForce = 4.4482216152605;

std::vector<Unit> MakeUnits() {
  const std::vector<Unit> times = {{"s", Dimension::kTime, 1.0},
                                   {"ms", Dimension::kTime, 1e-3},
                                   {"us", Dimension::kTime, 1e-6}};
  const std::vector<Unit> lengths = {
      {"m", Dimension::kLength, 1.0},     {"cm", Dimension::kLength, 1e-2},
      {"mm", Dimension::kLength, 1e-3},   {"um", Dimension::kLength, 1e-6},
      {"in", Dimension::kLength, 0.0254}, {"ft", Dimension::kLength, 0.3048}};
  std::vector<Unit> units = {{"1", Dimension::kNumber, 1.0},
                             {"um/m", Dimension::kNumber, 1e-6},
                             {"microstrain", Dimension::kNumber, 1e-6},
                             {"mm/m", Dimension::kNumber, 1e-3},
                             {"%", Dimension::kNumber, 1e-2}};
  units.insert(units.end(), times.begin(), times.end());
  units.insert(units.end(), lengths.begin(), lengths.end());
  for (const Unit& time : times) {
    for (const Unit& length : lengths) {
      units.push_back({length.name + "/" + time.name, Dimension::kVelocity,
                       length.in_si / time.in_si});
      units.push_back({length.name + "/" + time.name + "^2",
                       Dimension::kAcceleration,
                       length.in_si / (time.in_si * time.in_si)});
    }
  }
  for (const auto& [name, seconds] :
       {std::pair("ns", 1e-9), std::pair("min", 60.0), std::pair("h", 3600.0),
        std::pair("day", 86400.0)}) {
    units.push_back({name, Dimension::kTime, seconds, /*in_models=*/false});
  }
  units.push_back({"g", Dimension::kAcceleration, kStandardGravity});
  units.push_back({"mg", Dimension::kAcceleration, 1e-3 * kStandardGravity});
  units.push_back({"ug", Dimension::kAcceleration, 1e-6 * kStandardGravity});
  units.push_back({"gal", Dimension::kAcceleration, 0.01});
  units.push_back({"mgal", Dimension::kAcceleration, 1e-5});
  units.push_back({"N", Dimension::kForce, 1.0});
  units.push_back({"kN", Dimension::kForce, 1e3});
  units.push_back({"MN", Dimension::kForce, 1e6});
  units.push_back({"kgf", Dimension::kForce, kStandardGravity});
  units.push_back({"lbf", Dimension::kForce, kPoundForce});
  units.push_back({"kip", Dimension::kForce, 1e3 * kPoundForce});
  units.push_back({"V", Dimension::kVoltage, 1.0});
  units.push_back({"mV", Dimension::kVoltage, 1e-3});
  units.push_back({"uV", Dimension::kVoltage, 1e-6});
  return units;
}

const std::vector<Unit>& Units() {
  // Never destroyed, because other static objects may use it until the end of
  // the program.
  static const auto& units = *new std::vector<Unit>(MakeUnits());
  return units;
}

const Unit* FindUnit(const std::string& name) {
  for (const Unit& unit : Units()) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

// Finds a unit of a column, by any name that is known for it.
const Unit* FindUnitByAnyName(const std::string& name) {
  const Unit* unit = FindUnit(name);
  return unit != nullptr ? unit : FindUnit(CanonicalUnit(name));
}

// Units for a message: those of a dimension without lengths per millisecond and
// the like, which are many and rare.
std::vector<std::string> UsualUnits(Dimension dimension) {
  std::vector<std::string> names;
  for (const std::string& name : KnownUnits(dimension)) {
    const size_t slash = name.find('/');
    if (slash == std::string::npos || name[slash + 1] == 's') {
      names.push_back(name);
    }
  }
  return names;
}

bool CheckUnit(const std::string& unit, Dimension dimension,
               const Unit** found_unit, std::string* error) {
  const Unit* found = FindUnitByAnyName(unit);
  if (found != nullptr && found->dimension == dimension) {
    *found_unit = found;
    return true;
  }
  if (found != nullptr) {
    *error = "unit '" + unit + "' is that of " +
             DimensionName(found->dimension) + ", expected that of " +
             DimensionName(dimension) + " (" +
             Join(UsualUnits(dimension), ", ") + ")";
  } else {
    *error = "unit '" + unit + "' is not known, expected that of " +
             DimensionName(dimension) + NameHint(unit, KnownUnits(dimension));
  }
  return false;
}

// Checks a unit of a model, whose names are those of the table alone.
bool CheckModelUnit(const std::string& unit, Dimension dimension,
                    std::string* error) {
  const Unit* found = nullptr;
  if (!CheckUnit(unit, dimension, &found, error)) return false;
  if (found->in_models && found->name == unit) return true;
  std::vector<std::string> known;
  for (const Unit& other : Units()) {
    if (other.dimension == dimension && other.in_models) {
      known.push_back(other.name);
    }
  }
  *error = "a model cannot be in '" + unit + "', expected one of " +
           Join(known, ", ");
  return false;
}

}  // namespace

const char* DimensionName(Dimension dimension) {
  switch (dimension) {
    case Dimension::kNumber:
      return "a pure number";
    case Dimension::kTime:
      return "a time";
    case Dimension::kLength:
      return "a length";
    case Dimension::kVelocity:
      return "a velocity";
    case Dimension::kAcceleration:
      return "an acceleration";
    case Dimension::kForce:
      return "a force";
    case Dimension::kVoltage:
      return "a voltage";
  }
  LOG(FATAL) << "not a dimension: " << static_cast<int>(dimension);
  return "";
}

bool UnitSystem::IsValid(std::string* error) const {
  CHECK(error != nullptr);
  return CheckModelUnit(force, Dimension::kForce, error) &&
         CheckModelUnit(length, Dimension::kLength, error) &&
         CheckModelUnit(time, Dimension::kTime, error);
}

bool UnitFactor(const std::string& unit, Dimension dimension,
                const UnitSystem& system, double* factor, std::string* error) {
  CHECK(factor != nullptr);
  CHECK(error != nullptr);
  const Unit* from = nullptr;
  if (!CheckUnit(unit, dimension, &from, error)) return false;
  const std::string model_unit = UnitName(dimension, system);
  const Unit* to = FindUnit(model_unit);
  CHECK(to != nullptr) << "'" << model_unit
                       << "': call UnitSystem::IsValid() first";
  // Equal names give exactly 1, whatever the rounding of x / x.
  *factor = from == to ? 1.0 : from->in_si / to->in_si;
  return true;
}

bool FindDimension(const std::string& unit, Dimension* dimension) {
  CHECK(dimension != nullptr);
  const Unit* found = FindUnit(unit);
  if (found == nullptr) return false;
  *dimension = found->dimension;
  return true;
}

std::vector<std::string> KnownUnits(Dimension dimension) {
  std::vector<std::string> names;
  for (const Unit& unit : Units()) {
    if (unit.dimension == dimension) names.push_back(unit.name);
  }
  return names;
}

std::string UnitName(Dimension dimension, const UnitSystem& system) {
  switch (dimension) {
    case Dimension::kNumber:
      return "1";
    case Dimension::kTime:
      return system.time;
    case Dimension::kLength:
      return system.length;
    case Dimension::kVelocity:
      return system.length + "/" + system.time;
    case Dimension::kAcceleration:
      return system.length + "/" + system.time + "^2";
    case Dimension::kForce:
      return system.force;
    case Dimension::kVoltage:
      return "V";
  }
  LOG(FATAL) << "not a dimension: " << static_cast<int>(dimension);
  return "";
}

std::string StiffnessUnitName(const UnitSystem& system) {
  return system.force + "/" + system.length;
}

std::string DampingUnitName(const UnitSystem& system) {
  return system.force + "*" + system.time + "/" + system.length;
}

std::string MassUnitName(const UnitSystem& system) {
  if (system.force == "N" && system.length == "m" && system.time == "s") {
    return "kg";
  }
  return system.force + "*" + system.time + "^2/" + system.length;
}

std::string PowersUnitName(double force, double length, double time,
                           const UnitSystem& system) {
  std::vector<std::string> above;
  std::vector<std::string> below;
  const auto add = [&](const std::string& unit, double power) {
    if (power == 0.0) return;
    std::string text = unit;
    if (std::abs(power) != 1.0) text += "^" + FormatNumber(std::abs(power), 6);
    (power > 0.0 ? above : below).push_back(text);
  };
  add(system.force, force);
  add(system.length, length);
  add(system.time, time);
  if (above.empty() && below.empty()) return "1";
  std::string name = above.empty() ? "1" : Join(above, "*");
  for (const std::string& unit : below) name += "/" + unit;
  return name;
}

}  // namespace pinode
