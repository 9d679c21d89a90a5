#include "pinode/case/sections/discover_section.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/sections/feature_text.h"
#include "pinode/dynamics/memory_network.h"

namespace pinode {
namespace {

// Reads features in the notation of the library.
bool ReadFeatures(const TomlTable& table, const std::string& key,
                  const StructuralDynamics& dynamics,
                  std::vector<std::string>* names) {
  if (!table.Has(key)) return true;
  names->clear();
  for (const std::string& text : table.Strings(key)) {
    Feature feature;
    if (!ParseFeature(table, key, dynamics, text, &feature)) return false;
    names->push_back(
        feature.Name(dynamics.model().dof_names, InputNames(dynamics)));
  }
  return table.errors()->ok();
}

// Reads keys; absent ones leave *library unchanged.
bool ReadLibraryKeys(const TomlTable& table, const StructuralDynamics& dynamics,
                     CandidateLibraryOptions* library) {
  library->constant = table.Boolean("constant", library->constant);
  library->polynomial_degree =
      table.Integer("polynomial_degree", library->polynomial_degree, 0, 20);
  library->products = table.Boolean("products", library->products);
  if (table.Has("expressions")) {
    library->expressions = table.Strings("expressions");
  }
  return table.errors()->ok() &&
         ReadFeatures(table, "polynomial_features", dynamics,
                      &library->polynomial_features) &&
         ReadFeatures(table, "sine", dynamics, &library->sine_features) &&
         ReadFeatures(table, "cosine", dynamics, &library->cosine_features) &&
         ReadFeatures(table, "absolute", dynamics,
                      &library->absolute_features) &&
         ReadFeatures(table, "sign", dynamics, &library->sign_features) &&
         ReadFeatures(table, "signed_square", dynamics,
                      &library->signed_square_features);
}

bool ReadOutput(const TomlTable& table, const StructuralDynamics& dynamics,
                DiscoveryOptions::Output* output) {
  if (!table.AllowKeys()) return false;
  output->name = table.RequiredString("name");
  if (!table.errors()->ok()) return false;
  std::vector<std::string> names;
  for (const NetworkTerm& term : dynamics.networks()) {
    names.insert(names.end(), term.output_names.begin(),
                 term.output_names.end());
  }
  if (std::find(names.begin(), names.end(), output->name) == names.end()) {
    return table.Fail("name", "no network has an output '" + output->name +
                                  "'" + NameHint(output->name, names));
  }
  if (!ReadLibraryKeys(table, dynamics, &output->library)) return false;
  const TomlTable given = table.Table("given", "[[discover.output]] given");
  for (const auto& entry : given.entries()) {
    output->constraints.push_back(CoefficientConstraint::Given(
        entry.first, given.Number(entry.first, 0.0)));
  }
  for (const std::string& basis : table.Strings("positive")) {
    output->constraints.push_back(CoefficientConstraint::Positive(basis));
  }
  for (const std::string& basis : table.Strings("negative")) {
    output->constraints.push_back(CoefficientConstraint::Negative(basis));
  }
  return table.errors()->ok();
}

}  // namespace

bool ReadDiscover(const TomlTable& root, const StructuralDynamics& dynamics,
                  DiscoveryOptions* options) {
  const TomlTable table = root.Table("discover", "[discover]");
  if (!root.errors()->ok() || !table.AllowKeys()) return false;
  options->source = table.Choice("source", {"network", "derivatives"},
                                 "network") == "derivatives"
                        ? DiscoveryOptions::Source::kDerivatives
                        : DiscoveryOptions::Source::kNetwork;
  options->solver =
      table.Choice("solver", {"lasso", "stlsq"}, "lasso") == "stlsq"
          ? DiscoveryOptions::Solver::kStlsq
          : DiscoveryOptions::Solver::kLasso;
  options->tolerance = table.PositiveNumber("tolerance", options->tolerance);
  options->num_bags = table.Integer("bags", options->num_bags, 0, 10000);
  options->library_fraction =
      table.PositiveNumber("library_fraction", options->library_fraction);
  options->seed = static_cast<uint64_t>(
      table.Integer("seed", static_cast<int>(options->seed), 0,
                    std::numeric_limits<int>::max()));
  options->prune_fraction =
      table.NonNegativeNumber("prune_fraction", options->prune_fraction);
  options->refit = table.Boolean("refit", options->refit);
  options->search = table.Boolean("search", options->search);
  options->networks = table.Strings("networks");
  if (!table.errors()->ok()) return false;
  std::vector<std::string> names;
  for (const NetworkTerm& term : dynamics.networks()) {
    names.push_back(term.name);
  }
  for (const std::string& name : options->networks) {
    for (const LawTerm& term : dynamics.laws()) {
      if (term.name != name || AsMemoryNetwork(term) == nullptr) continue;
      return table.Fail("networks",
                        "'" + name +
                            "' is a network with memory, which pinode_discover "
                            "does not replace; add a network without 'memory'");
    }
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      return table.Fail("networks", "there is no network '" + name + "'" +
                                        NameHint(name, names));
    }
  }
  for (const std::string& text : table.Strings("features")) {
    Feature feature;
    if (!ParseFeature(table, "features", dynamics, text, &feature)) {
      return false;
    }
    options->features.push_back(feature);
  }
  if (!ReadLibraryKeys(table, dynamics, &options->library)) return false;
  std::set<std::string> seen;
  for (const TomlTable& output_table : table.Tables("output", "discover")) {
    DiscoveryOptions::Output output;
    output.library = options->library;
    if (!ReadOutput(output_table, dynamics, &output)) return false;
    if (!seen.insert(output.name).second) {
      return output_table.Fail(
          "name", "the output '" + output.name + "' is given twice");
    }
    options->outputs.push_back(std::move(output));
  }
  std::string error;
  if (!table.errors()->ok()) return false;
  return options->IsValid(&error) || table.Fail("tolerance", error);
}

}  // namespace pinode
