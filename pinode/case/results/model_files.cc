#include "pinode/case/results/model_files.h"

#include <filesystem>
#include <vector>

#include "pinode/network/network_json.h"
#include "pinode/structure/matrices/matrix_io.h"

namespace pinode {

bool WriteModelFiles(const StructuralDynamics& dynamics,
                     const std::string& folder, std::string* error) {
  const auto path = [&folder](const std::string& name) {
    return (std::filesystem::path(folder) / name).string();
  };
  const StructuralModel updated =
      dynamics.CorrectedModel(dynamics.Parameters());
  if (!WriteMatrixMarket(path("M.mtx"), updated.mass, error) ||
      !WriteMatrixMarket(path("K.mtx"), updated.stiffness, error) ||
      !WriteMatrixMarket(path("C.mtx"), updated.damping, error)) {
    return false;
  }
  std::vector<std::string> input_names;
  for (const InputSpec& input : dynamics.inputs()) {
    input_names.push_back(input.name);
  }
  for (const NetworkTerm& term : dynamics.networks()) {
    SavedNetwork saved;
    saved.architecture = term.network->architecture();
    for (const Feature& feature : term.features) {
      saved.inputs.push_back(
          feature.Name(dynamics.model().dof_names, input_names));
    }
    saved.outputs = term.output_names;
    saved.weights = term.weights.Values();
    if (!WriteNetwork(path(NetworkFileName(term)), saved, error)) return false;
  }
  return true;
}

std::string NetworkFileName(const NetworkTerm& term) {
  return "network_" + term.name + ".json";
}

}  // namespace pinode
