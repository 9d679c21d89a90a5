#include "pinode/base/parameter_block.h"

#include <cmath>
#include <set>
#include <sstream>

#include "pinode/base/logging.h"

namespace pinode {

Vector ParameterBlock::Values() const {
  Vector values(size());
  for (int i = 0; i < size(); ++i) {
    values[i] = parameters[static_cast<size_t>(i)].value;
  }
  return values;
}

void ParameterBlock::SetValues(const Vector& values) {
  CHECK_EQ(values.size(), size())
      << "block '" << name << "' takes one value per parameter";
  for (int i = 0; i < size(); ++i) {
    parameters[static_cast<size_t>(i)].value = values[i];
  }
}

bool ParameterBlock::IsValid(std::string* error) const {
  std::set<std::string> seen;
  for (const Parameter& parameter : parameters) {
    std::ostringstream message;
    if (!std::isfinite(parameter.value)) {
      message << "its value is not finite";
    } else if (std::isnan(parameter.lower) || std::isnan(parameter.upper) ||
               !(parameter.lower < parameter.upper)) {
      message << "its bounds are crossed: lower " << parameter.lower
              << ", upper " << parameter.upper;
    } else if (parameter.value < parameter.lower ||
               parameter.value > parameter.upper) {
      message << "its value " << parameter.value << " lies outside its bounds ["
              << parameter.lower << ", " << parameter.upper << "]";
    } else if (!(parameter.prior_sigma > 0.0)) {
      message << "its prior standard deviation " << parameter.prior_sigma
              << " is not positive";
    } else if (named && !seen.insert(parameter.name).second) {
      message << "this name is used twice, expected different names";
    } else {
      continue;
    }
    *error = "parameter '" + parameter.name + "': " + message.str();
    return false;
  }
  if (!decays.empty() && decays.size() != parameters.size()) {
    *error = "block '" + name + "': 'decays' needs one entry per parameter";
    return false;
  }
  return true;
}

}  // namespace pinode
