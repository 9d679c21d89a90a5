// The units that case files know, and their conversion to the model's own.

#ifndef PINODE_BASE_UNITS_H_
#define PINODE_BASE_UNITS_H_

#include <string>
#include <vector>

namespace pinode {

enum class Dimension {
  kNumber,
  kTime,
  kLength,
  kVelocity,
  kAcceleration,
  kForce,
  kVoltage  // of sensors whose sensitivity is not known
};

// "a number", "a time", "an acceleration", ... for messages.
const char* DimensionName(Dimension dimension);

// The units in which a model's matrices are written. The unit of mass is not
// chosen: it follows as force * time^2 / length, so that F = m a holds.
struct UnitSystem {
  std::string force = "N";   // N kN MN lbf kip
  std::string length = "m";  // m cm mm in ft
  std::string time = "s";    // s ms us

  // False, with the reason in *error, if one of the three is not a unit of its
  // dimension.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Finds the factor of  value_in_model_units = factor * value_in_unit. False if
// `unit` is not known or is not a unit of `dimension`: *error then names the
// unit, the dimension it has (if any), the one expected, and the nearest unit
// of that dimension. `system` is valid.
[[nodiscard]] bool UnitFactor(const std::string& unit, Dimension dimension,
                              const UnitSystem& system, double* factor,
                              std::string* error);

// All units of a dimension, in the order of the documentation.
std::vector<std::string> KnownUnits(Dimension dimension);

// The model's own unit of a dimension, such as "m/s^2"; "1" for numbers, "V"
// for voltages, whatever the system.
// UnitFactor() of it is 1.
std::string UnitName(Dimension dimension, const UnitSystem& system);

// force/length, force*time/length and force*time^2/length; the last is "kg"
// where it is just that.
std::string StiffnessUnitName(const UnitSystem& system);
std::string DampingUnitName(const UnitSystem& system);
std::string MassUnitName(const UnitSystem& system);

// "N/m^3" and the like from powers of force, length and time.
std::string PowersUnitName(double force, double length, double time,
                           const UnitSystem& system);

}  // namespace pinode

#endif  // PINODE_BASE_UNITS_H_
