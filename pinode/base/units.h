// Units in case files, and their conversion to the model's own units.

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

// Returns "a number", "a time", "an acceleration", ... for messages.
const char* DimensionName(Dimension dimension);

// Units of a model's matrices. The unit of mass follows as force * time^2 /
// length, so that F = m a holds.
struct UnitSystem {
  std::string force = "N";   // N kN MN lbf kip
  std::string length = "m";  // m cm mm in ft
  std::string time = "s";    // s ms us

  // Returns false, with the reason in *error, if one of the three is not a unit
  // of its dimension.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Finds the factor in value_in_model_units = factor * value_in_unit. Returns
// false if `unit` is not known or is not a unit of `dimension`. *error then
// names the unit, the dimension it has (if any), the expected dimension, and
// the nearest unit of that dimension. `system` must be valid.
[[nodiscard]] bool UnitFactor(const std::string& unit, Dimension dimension,
                              const UnitSystem& system, double* factor,
                              std::string* error);

// Returns all units of a dimension, in the order of the documentation.
std::vector<std::string> KnownUnits(Dimension dimension);

// Returns the model's own unit of a dimension, such as "m/s^2". It is "1" for
// numbers and "V" for voltages in every unit system. Its UnitFactor() is 1.
std::string UnitName(Dimension dimension, const UnitSystem& system);

// Return the names of force/length, force*time/length and force*time^2/length.
// The last one is "kg" if the unit equals a kilogram.
std::string StiffnessUnitName(const UnitSystem& system);
std::string DampingUnitName(const UnitSystem& system);
std::string MassUnitName(const UnitSystem& system);

// Returns "N/m^3" and similar names from powers of force, length and time.
std::string PowersUnitName(double force, double length, double time,
                           const UnitSystem& system);

}  // namespace pinode

#endif  // PINODE_BASE_UNITS_H_
