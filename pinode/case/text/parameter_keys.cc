#include "pinode/case/text/parameter_keys.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"

namespace pinode {

bool ReadParameterKeys(const TomlTable& table, double factor,
                       Parameter* parameter) {
  const double lowest = parameter->lower;
  const double highest = parameter->upper;
  const auto scaled = [&](const char* key, double absent) {
    return table.Has(key) ? factor * table.ExtendedNumber(key, 0.0) : absent;
  };
  parameter->value = table.Has("initial")
                         ? factor * table.Number("initial", 0.0)
                         : parameter->value;
  const char* lower_key = factor > 0.0 ? "lower" : "upper";
  const char* upper_key = factor > 0.0 ? "upper" : "lower";
  parameter->lower = scaled(lower_key, lowest);
  parameter->upper = scaled(upper_key, highest);
  parameter->prior_mean = table.Has("prior_mean")
                              ? factor * table.Number("prior_mean", 0.0)
                              : parameter->value;
  if (table.Has("prior_sigma")) {
    parameter->prior_sigma =
        std::abs(factor) * table.PositiveNumber("prior_sigma", 1.0);
  }
  parameter->free = table.Boolean("free", parameter->free);
  if (!table.errors()->ok()) return false;

  if (!(parameter->lower < parameter->upper)) {
    return table.Fail(
        table.Has("lower") ? "lower" : "upper",
        "the bounds of '" + parameter->name + "' are crossed: lower " +
            FormatNumber(parameter->lower / factor, 6) + ", upper " +
            FormatNumber(parameter->upper / factor, 6) +
            ", expected lower < upper");
  }
  if (parameter->lower < lowest || parameter->upper > highest) {
    return table.Fail(parameter->lower < lowest ? lower_key : upper_key,
                      "the bounds of '" + parameter->name +
                          "' leave its physical range, expected them within [" +
                          FormatNumber(lowest, 6) + ", " +
                          FormatNumber(highest, 6) + "]");
  }
  // Unit conversion may have rounded a value beyond its bound.
  for (const double bound : {parameter->lower, parameter->upper}) {
    if (std::isfinite(bound) &&
        std::abs(parameter->value - bound) <= 1e-14 * std::abs(bound)) {
      parameter->value = bound;
    }
  }
  if (parameter->value < parameter->lower ||
      parameter->value > parameter->upper) {
    return table.Fail(
        "initial", "the initial value of '" + parameter->name + "', " +
                       FormatNumber(parameter->value / factor, 6) +
                       ", lies outside its bounds, expected a value within [" +
                       FormatNumber(parameter->lower, 6) + ", " +
                       FormatNumber(parameter->upper, 6) + "]");
  }
  return true;
}

bool CheckName(const TomlTable& table, const std::string& key,
               const std::string& name) {
  const bool good = !name.empty() && name.size() <= 100 && name[0] != '.' &&
                    std::all_of(name.begin(), name.end(), [](char c) {
                      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                             (c >= '0' && c <= '9') || c == '_' || c == '-' ||
                             c == '.' || c == '+' ||
                             static_cast<unsigned char>(c) >= 0x80;
                    });
  if (good) return true;
  return table.Fail(key,
                    "'" + name +
                        "' cannot be a name here, because files get this name; "
                        "use letters, digits, '_', '-', '.' and '+'");
}

}  // namespace pinode
