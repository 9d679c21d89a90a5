#include "pinode/case/sections/modes_frf_section.h"

#include <string>
#include <utility>
#include <vector>

namespace pinode {
namespace {

const std::vector<std::string>& EstimatorNames() {
  static const std::vector<std::string> names = {"h1", "h2", "hv"};
  return names;
}

const std::vector<std::string>& ExcitationNames() {
  static const std::vector<std::string> names = {"automatic", "blows", "random",
                                                 "periodic"};
  return names;
}

// Finds `name` in the names of the values of an enumeration, in their order.
template <typename Enumeration>
bool ParseNamed(const std::string& name, const std::vector<std::string>& names,
                Enumeration* value) {
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] != name) continue;
    *value = static_cast<Enumeration>(i);
    return true;
  }
  return false;
}

}  // namespace

bool ParseFrfEstimator(const std::string& name, FrfEstimator* estimator) {
  return ParseNamed(name, EstimatorNames(), estimator);
}

bool ParseFrfExcitation(const std::string& name, FrfExcitation* excitation) {
  return ParseNamed(name, ExcitationNames(), excitation);
}

bool ReadModesFrfSection(const TomlTable& table, ModesFrfSection* section) {
  if (!table.AllowKeys()) return false;
  FrfEstimateOptions& options = section->options;
  const std::string estimator =
      table.Choice("estimator", EstimatorNames(), "h1");
  const std::string excitation =
      table.Choice("excitation", ExcitationNames(), "automatic");
  section->has_overlap = table.Has("overlap");
  options.overlap = table.NonNegativeNumber("overlap", options.overlap);
  if (table.Has("block")) section->block = table.PositiveNumber("block", 1.0);
  if (table.Has("force_window")) {
    options.force_window = table.PositiveNumber("force_window", 1.0);
  }
  if (table.Has("exponential_window")) {
    options.exponential_window =
        table.PositiveNumber("exponential_window", 1.0);
  }
  if (!table.errors()->ok()) return false;
  if (!(options.overlap < 1.0)) {
    return table.Fail("overlap", "expected a share below 1");
  }
  return ParseFrfEstimator(estimator, &options.estimator) &&
         ParseFrfExcitation(excitation, &options.excitation);
}

}  // namespace pinode
