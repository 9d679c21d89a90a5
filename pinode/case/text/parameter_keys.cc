#include "pinode/case/text/parameter_keys.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Reads `tie` and `tie_factor`. `parameter` has its physical bounds.
bool ReadTie(const TomlTable& table, Parameter* parameter) {
  for (const char* key :
       {"initial", "lower", "upper", "prior_mean", "prior_sigma", "free"}) {
    if (!table.Has(key)) continue;
    return table.Fail(key, std::string("'") + key +
                               "' belongs to an unknown of its own; '" +
                               parameter->name + "' has 'tie', so remove one");
  }
  parameter->tie = table.String("tie");
  parameter->tie_factor = table.Number("tie_factor", 1.0);
  parameter->free = false;
  // Any value that is allowed will do until that of the source is known.
  parameter->value =
      std::clamp(std::isfinite(parameter->value) ? parameter->value : 0.0,
                 parameter->lower, parameter->upper);
  parameter->prior_mean = parameter->value;
  table.errors()->NoteTie(parameter->name, table.Line("tie"));
  return table.errors()->ok();
}

}  // namespace

bool ReadParameterKeys(const TomlTable& table, double factor,
                       Parameter* parameter) {
  if (table.Has("tie")) return ReadTie(table, parameter);
  if (table.Has("tie_factor")) {
    return table.Fail("tie_factor",
                      "'tie_factor' needs 'tie', the name of "
                      "the unknown to follow");
  }
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
