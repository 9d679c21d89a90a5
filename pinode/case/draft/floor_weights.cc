#include "pinode/case/draft/floor_weights.h"

#include <cmath>
#include <string_view>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"

namespace pinode {
namespace {

struct Amount {
  double value = 0.0;
  std::string unit;
};

// Splits "900kN", "900 kN" or "900" at the end of the number.
bool SplitNumber(std::string_view text, Amount* amount) {
  size_t end = text.find_first_not_of("+-0123456789.");
  if (end == std::string_view::npos) end = text.size();
  // An exponent, unless a unit begins with that letter.
  if (end + 1 < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const size_t digits = text.find_first_not_of("0123456789", end + 2);
    if (std::string_view("+-0123456789").find(text[end + 1]) !=
        std::string_view::npos) {
      end = digits == std::string_view::npos ? text.size() : digits;
    }
  }
  amount->unit = std::string(StripBlanks(text.substr(end)));
  return ParseDouble(StripBlanks(text.substr(0, end)), &amount->value) &&
         std::isfinite(amount->value);
}

// Reads values with units, separated by commas, one for all or one for each.
bool ParseAmounts(const std::string& text, const std::string& flag,
                  const std::string& example, int storeys,
                  std::vector<Amount>* amounts, std::string* error) {
  amounts->clear();
  for (const std::string_view part : Split(text, ',')) {
    Amount amount;
    if (!SplitNumber(part, &amount)) {
      *error = flag + ": " + Quote(part) + " is not a number with a unit; " +
               "write " + example + ", with a decimal point";
      return false;
    }
    if (amount.value <= 0.0) {
      *error = flag + ": " + Quote(part) + ", expected a positive value";
      return false;
    }
    amounts->push_back(amount);
  }
  std::string unit;
  for (size_t i = amounts->size(); i-- > 0;) {
    Amount& amount = (*amounts)[i];
    if (!amount.unit.empty()) unit = amount.unit;
    if (unit.empty()) {
      *error = flag + ": " + FormatNumber(amount.value) +
               " has no unit; write " + example;
      return false;
    }
    amount.unit = unit;
  }
  if (amounts->size() == 1) {
    amounts->resize(static_cast<size_t>(storeys), amounts->front());
  }
  if (amounts->size() != static_cast<size_t>(storeys)) {
    *error = flag + " has " + std::to_string(amounts->size()) +
             " values, the building has " + std::to_string(storeys) +
             " storeys; give one for all or " + std::to_string(storeys) +
             ", from the lowest up";
    return false;
  }
  return true;
}

// Returns the factor from a unit of mass to kg; 0: no such unit.
double Kilograms(const std::string& unit) {
  if (unit == "kg") return 1.0;
  if (unit == "t" || unit == "Mg" || unit == "tonne" || unit == "tonnes") {
    return 1000.0;
  }
  return 0.0;
}

UnitSystem UnitsFor(const std::string& unit) {
  UnitSystem units;
  if (Kilograms(unit) == 1000.0 || unit == "kN" || unit == "MN") {
    units.force = "kN";
  } else if (unit == "kip" || unit == "lbf") {
    units.force = "kip";
    units.length = "in";
  }
  return units;
}

// Returns the name in the table of units of a force; empty: it is none.
std::string ForceName(const std::string& unit) {
  const std::string name = unit == "lbm" ? "lbf" : CanonicalUnit(unit);
  Dimension dimension;
  return FindDimension(name, &dimension) && dimension == Dimension::kForce
             ? name
             : "";
}

}  // namespace

bool ParseFloorWeights(const std::string& text, int storeys,
                       FloorMasses* masses, std::string* error) {
  const std::string flag = "--weights";
  std::vector<Amount> amounts;
  if (!ParseAmounts(text, flag, "--weights=\"900 kN\" or \"2000 kg\"", storeys,
                    &amounts, error)) {
    return false;
  }
  FloorMasses result;
  for (size_t i = 0; i < amounts.size(); ++i) {
    const Amount& amount = amounts[i];
    const double kilograms = Kilograms(amount.unit);
    const std::string force = kilograms > 0.0 ? "" : ForceName(amount.unit);
    if (kilograms == 0.0 && force.empty()) {
      const std::string low = LowerCase(amount.unit);
      *error = flag + ": " + Quote(amount.unit) +
               (low == "ton" || low == "tons"
                    ? " has several meanings; write t (1000 kg), or kip"
                    : " is not a unit of weight or mass; use one of N kN MN "
                      "kgf lbf kip kg t");
      return false;
    }
    if (i == 0) result.units = UnitsFor(kilograms > 0.0 ? amount.unit : force);
    double newton = 0.0;
    double metre = 0.0;
    double gravity = 0.0;
    double to_force = 0.0;
    if (!UnitFactor("N", Dimension::kForce, result.units, &newton, error) ||
        !UnitFactor("m", Dimension::kLength, result.units, &metre, error) ||
        !UnitFactor("g", Dimension::kAcceleration, result.units, &gravity,
                    error) ||
        (!force.empty() && !UnitFactor(force, Dimension::kForce, result.units,
                                       &to_force, error))) {
      return false;
    }
    result.masses.push_back(kilograms > 0.0
                                ? amount.value * kilograms * newton / metre
                                : amount.value * to_force / gravity);
    if (kilograms > 0.0) {
      result.origin = "from --weights (masses)";
    } else {
      result.origin = "weights / g, g = " + FormatNumber(gravity, 6) + " " +
                      UnitName(Dimension::kAcceleration, result.units);
    }
  }
  *masses = std::move(result);
  return true;
}

bool ParseStoreyStiffnesses(const std::string& text, int storeys,
                            const UnitSystem& units,
                            std::vector<double>* stiffnesses,
                            std::string* error) {
  const std::string flag = "--stiffness";
  const std::string example = "--stiffness=\"150000 kN/m\"";
  std::vector<Amount> amounts;
  if (!ParseAmounts(text, flag, example, storeys, &amounts, error)) {
    return false;
  }
  std::vector<double> result;
  for (const Amount& amount : amounts) {
    const size_t slash = amount.unit.find('/');
    double force = 0.0;
    double length = 0.0;
    std::string ignored;
    if (slash == std::string::npos ||
        !UnitFactor(CanonicalUnit(amount.unit.substr(0, slash)),
                    Dimension::kForce, units, &force, &ignored) ||
        !UnitFactor(CanonicalUnit(amount.unit.substr(slash + 1)),
                    Dimension::kLength, units, &length, &ignored)) {
      *error = flag + ": " + Quote(amount.unit) +
               " is not a force over a length; write " + example +
               ", N/mm or kip/in";
      return false;
    }
    result.push_back(amount.value * force / length);
  }
  *stiffnesses = std::move(result);
  return true;
}

}  // namespace pinode
