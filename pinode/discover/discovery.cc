#include "pinode/discover/discovery.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/discover/ensemble.h"
#include "pinode/discover/network_outputs.h"
#include "pinode/discover/output_regression.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/network/network.h"

namespace pinode {
namespace {

bool IsAskedFor(const DiscoveryOptions& options, const NetworkTerm& term) {
  return options.networks.empty() ||
         std::find(options.networks.begin(), options.networks.end(),
                   term.name) != options.networks.end();
}

std::vector<std::string> NamesOf(const std::vector<Feature>& features,
                                 const StructuralDynamics& dynamics) {
  std::vector<std::string> input_names;
  for (const InputSpec& input : dynamics.inputs()) {
    input_names.push_back(input.name);
  }
  std::vector<std::string> names;
  for (const Feature& feature : features) {
    names.push_back(feature.Name(dynamics.model().dof_names, input_names));
  }
  return names;
}

// Returns the RMS of the accelerations or forces on the DOFs of one output (a
// column of NetworkTerm::outputs), in its unit. `cause`: DOFs x samples.
double ScaleOf(const Vector& output, const Matrix& cause) {
  // The DOF of a pair that moves less determines the scale.
  double scale = std::numeric_limits<double>::infinity();
  for (Eigen::Index dof = 0; dof < output.size(); ++dof) {
    if (output[dof] == 0.0) continue;
    scale = std::min(scale, RmsOfPresent(cause.row(dof).transpose()) /
                                std::abs(output[dof]));
  }
  return scale;
}

// Finds the equations of network j.
bool FindEquationsOf(const StructuralDynamics& dynamics, size_t j,
                     const DiscoveryOptions& options,
                     const NetworkOutputs& data,
                     std::vector<DiscoveredEquation>* equations,
                     std::string* error) {
  const NetworkTerm& term = dynamics.networks()[j];
  const int n = dynamics.num_dofs();
  const std::vector<Feature>& features =
      options.features.empty() ? term.features : options.features;
  const Matrix feature_values = FeatureValues(features, n, data.samples);
  const Matrix accelerations = data.samples.rates.middleRows(n, n);
  const Matrix cause = term.acts_as == ActsAs::kForce
                           ? Matrix(data.mass * accelerations)
                           : accelerations;
  for (Eigen::Index o = 0; o < term.outputs.cols(); ++o) {
    DiscoveredEquation equation;
    equation.network = term.name;
    equation.output = term.output_names[static_cast<size_t>(o)];
    equation.acts_as = term.acts_as;
    equation.features = features;
    equation.feature_names = NamesOf(features, dynamics);
    equation.scale = ScaleOf(term.outputs.col(o), cause);
    if (!(equation.scale > 0.0) || !std::isfinite(equation.scale)) {
      *error = "output '" + equation.output + "' of network '" + term.name +
               "' acts at a place that does not move in the training records";
      return false;
    }
    equation.uncertainty = data.uncertainty[j][o] / equation.scale;
    if (!RegressOutput(options, feature_values, data.samples.record_starts,
                       data.outputs[j].col(o),
                       term.network->architecture().gauge, &equation, error)) {
      return false;
    }
    equations->push_back(std::move(equation));
  }
  return true;
}

bool FindEquations(const StructuralDynamics& dynamics,
                   const DiscoveryOptions& options, const NetworkOutputs& data,
                   std::vector<DiscoveredEquation>* equations,
                   std::string* error) {
  std::vector<DiscoveredEquation> found;
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    if (!IsAskedFor(options, dynamics.networks()[j])) continue;
    if (!FindEquationsOf(dynamics, j, options, data, &found, error)) {
      return false;
    }
  }
  *equations = std::move(found);
  return true;
}

bool CheckOptions(const StructuralDynamics& dynamics,
                  const DiscoveryOptions& options, std::string* error) {
  if (!options.IsValid(error)) return false;
  if (dynamics.networks().empty()) {
    for (const LawTerm& term : dynamics.laws()) {
      if (AsMemoryNetwork(term) == nullptr) continue;
      *error = "'" + term.name +
               "' is a network with memory, which discovery does not replace. "
               "Add a network without 'memory'";
      return false;
    }
    *error =
        "the model has no network. Terms are looked for where a network acts: "
        "add one at the DOFs that the unknown law may act on";
    return false;
  }
  for (const DiscoveryOptions::Output& output : options.outputs) {
    bool found = false;
    for (const NetworkTerm& term : dynamics.networks()) {
      found =
          found || std::find(term.output_names.begin(), term.output_names.end(),
                             output.name) != term.output_names.end();
    }
    if (!found) {
      *error = "no network has an output '" + output.name + "'";
      return false;
    }
  }
  return true;
}

// Checks that records alone suffice for the options.
bool CheckForRecords(const StructuralDynamics& dynamics,
                     const DiscoveryOptions& options, std::string* error) {
  if (dynamics.num_internal() > 0) {
    *error =
        "records do not show internal states of elements; leave such elements "
        "out with source = \"derivatives\"";
    return false;
  }
  if (!options.networks.empty() &&
      options.networks.size() < dynamics.networks().size()) {
    *error =
        "source = \"derivatives\" replaces all networks at once, because none "
        "of them is trained";
    return false;
  }
  return true;
}

}  // namespace

const DiscoveryOptions::Output* DiscoveryOptions::Find(
    const std::string& output) const {
  for (const Output& candidate : outputs) {
    if (candidate.name == output) return &candidate;
  }
  return nullptr;
}

bool DiscoveryOptions::IsValid(std::string* error) const {
  const auto fail = [error](const std::string& message) {
    *error = message;
    return false;
  };
  if (!(tolerance > 0.0) || !(tolerance < 1.0)) {
    return fail("tolerance is " + FormatNumber(tolerance, 6) +
                ", expected more than 0 and less than 1");
  }
  if (!(prune_fraction >= 0.0) || !(prune_fraction <= 1.0)) {
    return fail("prune_fraction is " + FormatNumber(prune_fraction, 6) +
                ", expected 0 to 1");
  }
  if (num_bags < 0) {
    return fail("num_bags is " + std::to_string(num_bags) +
                ", expected 0 or more");
  }
  if (num_bags > 0) {
    EnsembleOptions ensemble;
    ensemble.num_bags = num_bags;
    ensemble.library_fraction = library_fraction;
    ensemble.num_threads = num_threads;
    if (!ensemble.IsValid(error)) return false;
  }
  for (const Output& output : outputs) {
    for (const CoefficientConstraint& constraint : output.constraints) {
      if (constraint.kind == CoefficientConstraint::Kind::kEqual) {
        return fail(
            "output '" + output.name +
            "': equal coefficients are not possible as conditions here");
      }
    }
  }
  return true;
}

bool DiscoverFromNetworks(const IdentificationProblem& problem,
                          const IdentifiedModel& model,
                          const DiscoveryOptions& options,
                          std::vector<DiscoveredEquation>* equations,
                          std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  NetworkOutputs data;
  return CheckOptions(dynamics, options, error) &&
         OutputsOfTrainedNetworks(problem, model, &data, error) &&
         FindEquations(dynamics, options, data, equations, error);
}

bool DiscoverFromDerivatives(const IdentificationProblem& problem,
                             const DiscoveryOptions& options,
                             std::vector<DiscoveredEquation>* equations,
                             IdentifiedModel* model, std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  NetworkOutputs data;
  IdentifiedModel begin;
  if (!CheckOptions(dynamics, options, error) ||
      !CheckForRecords(dynamics, options, error) ||
      !OutputsFromRecords(problem, &data, &begin, error) ||
      !FindEquations(dynamics, options, data, equations, error)) {
    return false;
  }
  for (DiscoveredEquation& equation : *equations) {
    equation.source = DiscoveryOptions::Source::kDerivatives;
  }
  *model = std::move(begin);
  return true;
}

}  // namespace pinode
