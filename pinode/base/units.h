// Units of quantities, and their conversion to the model's own units.

#ifndef PINODE_BASE_UNITS_H_
#define PINODE_BASE_UNITS_H_

#include <string>
#include <vector>

namespace pinode {

// Physical dimension of a quantity.
enum class Dimension {
  kNumber,
  kTime,
  kLength,
  kVelocity,
  kAcceleration,
  kForce,
  kVoltage  // output of a sensor of unknown sensitivity
};

// Returns the dimension with its article, such as "a number" or "an
// acceleration", for messages.
const char* DimensionName(Dimension dimension);

// Units of a model's matrices, loads and responses. The unit of mass follows as
// force * time^2 / length, so that F = m a holds.
struct UnitSystem {
  std::string force = "N";   // N kN MN lbf kip
  std::string length = "m";  // m cm mm in ft
  std::string time = "s";    // s ms us

  // Returns false, with the reason in *error, if one of the three is not a unit
  // of its dimension.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Finds the factor that converts a unit: value_in_model_units = factor *
// value_in_unit. `system` must be valid.
//
// Returns false if `unit` is not known or is not a unit of `dimension`. *error
// then names the unit, its own dimension if it has one, and the expected
// dimension. It also suggests the nearest unit of that dimension.
[[nodiscard]] bool UnitFactor(const std::string& unit, Dimension dimension,
                              const UnitSystem& system, double* factor,
                              std::string* error);

// Returns the names of all units of a dimension, in the order of the
// documentation. The list is not empty.
std::vector<std::string> KnownUnits(Dimension dimension);

// Returns the model's own unit of a dimension, such as "m/s^2". It is "1" for
// numbers and "V" for voltages in every unit system. Its UnitFactor() is 1.
std::string UnitName(Dimension dimension, const UnitSystem& system);

// Return the units of stiffness (force/length), damping (force*time/length) and
// mass (force*time^2/length). The unit of mass is written "kg" if it equals a
// kilogram.
std::string StiffnessUnitName(const UnitSystem& system);
std::string DampingUnitName(const UnitSystem& system);
std::string MassUnitName(const UnitSystem& system);

// Returns the unit force^a * length^b * time^c for the given powers, such as
// "N/m^3" for 1, -3 and 0. It is "1" if all powers are 0.
std::string PowersUnitName(double force, double length, double time,
                           const UnitSystem& system);

}  // namespace pinode

#endif  // PINODE_BASE_UNITS_H_
