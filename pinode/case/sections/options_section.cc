#include "pinode/case/sections/options_section.h"

#include <algorithm>
#include <limits>
#include <string>

#include "pinode/base/parallel_for.h"
#include "pinode/base/strings.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

bool ReadOptions(const TomlTable& root, IdentificationOptions* options) {
  const TomlTable table = root.Table("options", "[options]");
  if (!table.AllowKeys()) {
    return false;
  }
  if (table.Choice("shooting", {"multiple", "single"}, "multiple") ==
      "single") {
    options->shooting = IdentificationOptions::Shooting::kSingle;
  }
  options->segment_samples =
      table.LongInteger("segment_samples", options->segment_samples, 0);
  options->max_num_iterations = table.Integer(
      "max_iterations", options->max_num_iterations, 0, 1000000000);
  const std::string loss =
      table.Choice("robust_loss", {"none", "huber", "cauchy"}, "none");
  options->loss = loss == "huber"    ? RobustLoss::kHuber
                  : loss == "cauchy" ? RobustLoss::kCauchy
                                     : RobustLoss::kNone;
  options->loss_scale =
      table.PositiveNumber("robust_scale", options->loss_scale);
  if (table.Choice("derivatives", {"tangents", "jets"}, "tangents") == "jets") {
    options->derivatives = DerivativeMethod::kJets;
  }
  const std::string covariance =
      table.Choice("covariance", {"auto", "plain", "sandwich"}, "auto");
  options->covariance =
      covariance == "plain"      ? IdentificationOptions::Covariance::kPlain
      : covariance == "sandwich" ? IdentificationOptions::Covariance::kSandwich
                                 : IdentificationOptions::Covariance::kAuto;
  options->num_threads = table.Integer("threads", DefaultThreads(), 1, 1024);
  options->num_starts =
      table.Integer("multistart", options->num_starts, 0, 10000);
  options->seed = static_cast<std::uint64_t>(
      table.Integer("seed", 1, 0, std::numeric_limits<int>::max()));
  options->function_tolerance =
      table.PositiveNumber("tolerance", options->function_tolerance);
  return table.errors()->ok();
}

bool ReadProfiles(const TomlTable& root, const IdentificationProblem& problem,
                  std::optional<std::vector<std::string>>* parameters) {
  parameters->reset();
  if (!root.Has("profiles")) return true;
  const TomlTable table = root.Table("profiles", "[profiles]");
  if (!table.AllowKeys()) return false;
  parameters->emplace();
  if (!table.Has("parameters")) return table.errors()->ok();
  const ParameterLayout layout(problem);
  std::vector<std::string> free;
  for (const int index : layout.free()) {
    if (layout.IsNamed(index)) free.push_back(layout.parameter(index).name);
  }
  for (const std::string& name : table.Strings("parameters")) {
    if (std::find(free.begin(), free.end(), name) == free.end()) {
      return table.Fail("parameters",
                        "'parameters' has '" + name +
                            "', expected the names of free parameters" +
                            NameHint(name, free));
    }
    (*parameters)->push_back(name);
  }
  return table.errors()->ok();
}

bool ReadSimulate(const TomlTable& root, double* noise_percent,
                  bool* noise_is_sigma, std::uint64_t* seed) {
  const TomlTable table = root.Table("simulate", "[simulate]");
  if (!table.AllowKeys()) return false;
  *noise_is_sigma = table.Has("noise");
  table.Choice("noise", {"sigma"}, "sigma");
  if (*noise_is_sigma && table.Has("noise_percent")) {
    return table.Fail(
        "noise_percent",
        "'noise_percent' and 'noise' are both given, expected one of them");
  }
  *noise_percent = table.NonNegativeNumber("noise_percent", 0.0);
  *seed = static_cast<std::uint64_t>(
      table.Integer("seed", 1, 0, std::numeric_limits<int>::max()));
  return table.errors()->ok();
}

}  // namespace pinode
