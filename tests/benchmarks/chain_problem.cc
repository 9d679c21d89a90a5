#include "tests/benchmarks/chain_problem.h"

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/dynamics/elements.h"
#include "pinode/integrate/free_run.h"
#include "pinode/network/initialize_weights.h"

namespace pinode {
namespace benchmarks {
namespace {

constexpr double kSamplingStep = 0.05;   // s
constexpr double kCubicStiffness = 2.0;  // N/m^3
constexpr double kNoise = 0.01;

StructuralModel MakeModel(int num_dofs, double factor) {
  Matrix links = Matrix::Zero(num_dofs, num_dofs);
  for (int i = 0; i < num_dofs; ++i) links += SpringMatrix(num_dofs, i - 1, i);
  const Matrix identity = Matrix::Identity(num_dofs, num_dofs);
  return MakeStructuralModel(identity, factor * kDamping * identity,
                             factor * kStiffness * links);
}

// A spring a link, or a damper between each mass and the ground.
void AddGroups(MatrixGroup::Target target, const std::string& prefix,
               double value, StructuralDynamics* dynamics) {
  const int n = dynamics->num_dofs();
  const bool springs = target == MatrixGroup::Target::kStiffness;
  for (int i = 0; i < n; ++i) {
    GroupTerm term;
    term.group.name = prefix + std::to_string(i + 1);
    term.group.target = target;
    term.group.matrix = value * SpringMatrix(n, springs ? i - 1 : -1, i);
    term.alpha.name = term.group.name;
    std::string error;
    CHECK(dynamics->AddGroup(std::move(term), &error)) << error;
  }
}

void AddNetwork(StructuralDynamics* dynamics) {
  NetworkArchitecture architecture;
  architecture.num_inputs = 8;
  architecture.num_outputs = 4;
  architecture.hidden_widths = {30};
  architecture.skip = false;
  NetworkTerm term;
  term.name = "network";
  term.network = std::make_shared<Network>(architecture);
  for (int i = 0; i < 4; ++i) {
    term.features.push_back(Feature::Displacement(i));
  }
  for (int i = 0; i < 4; ++i) term.features.push_back(Feature::Velocity(i));
  term.outputs = Matrix::Identity(dynamics->num_dofs(), 4);
  const Vector weights = InitializeWeights(architecture, 1, false);
  term.weights.name = term.name;
  term.weights.named = false;
  term.weights.parameters.resize(static_cast<size_t>(weights.size()));
  for (int i = 0; i < weights.size(); ++i) {
    Parameter& parameter = term.weights.parameters[static_cast<size_t>(i)];
    parameter.name = "network[" + std::to_string(i) + "]";
    parameter.value = weights[i];
  }
  term.weights.decays = architecture.NonlinearWeights();
  std::string error;
  CHECK(dynamics->AddNetwork(std::move(term), &error)) << error;
}

// Never repeats itself within the records: the frequencies are incommensurable.
Excitation MakeForce(int num_samples) {
  Matrix force(1, num_samples);
  for (int i = 0; i < num_samples; ++i) {
    const double t = i * kSamplingStep;
    force(0, i) = 3.0 * std::sin(1.1 * t) + 2.0 * std::sin(std::sqrt(7.0) * t) +
                  2.0 * std::sin(std::sqrt(19.0) * t);
  }
  return Excitation(0.0, kSamplingStep, force, Interpolation::kLinear);
}

std::vector<InputSpec> ForceInput() {
  return {{InputSpec::Kind::kForce, 0, "force"}};
}

}  // namespace

std::unique_ptr<StructuralDynamics> MakeChain(int num_dofs, bool groups,
                                              bool force) {
  auto dynamics = std::make_unique<StructuralDynamics>(
      MakeModel(num_dofs, 1.0),
      force ? ForceInput() : std::vector<InputSpec>());
  if (groups) {
    AddGroups(MatrixGroup::Target::kStiffness, "k", kStiffness, dynamics.get());
    AddGroups(MatrixGroup::Target::kDamping, "c", kDamping, dynamics.get());
  }
  AddNetwork(dynamics.get());
  return dynamics;
}

IdentificationProblem MakeChainProblem(int num_dofs, bool groups,
                                       int num_samples) {
  IdentificationRecord record;
  record.name = "forced";
  record.substeps = 1;
  record.excitation = MakeForce(num_samples);
  std::vector<Observation> observations;
  for (Quantity quantity : {Quantity::kDisplacement, Quantity::kVelocity}) {
    for (int i = 0; i < num_dofs; ++i) {
      Observation observation;
      observation.name = QuantityName(quantity) + std::to_string(i + 1);
      observation.quantity = quantity;
      observation.weights = Vector::Unit(num_dofs, i);
      observations.push_back(observation);
    }
  }

  StructuralDynamics truth(MakeModel(num_dofs, groups ? 0.95 : 1.0),
                           ForceInput());
  std::string error;
  LawTerm spring;
  spring.name = spring.type = "cubic";
  spring.law = CreateElement(spring.type, &error);
  CHECK(spring.law != nullptr) << error;
  spring.features = {Feature::Deformation(Feature::kGround, 0),
                     Feature::DeformationRate(Feature::kGround, 0)};
  spring.outputs = Vector::Unit(num_dofs, 0);
  spring.parameters.name = spring.name;
  for (const ElementParameterInfo& info : ElementParameters(spring.type)) {
    Parameter parameter;
    parameter.name = spring.name + "." + info.name;
    parameter.value = kCubicStiffness;
    spring.parameters.parameters.push_back(parameter);
  }
  CHECK(truth.AddLaw(std::move(spring), &error)) << error;
  StructuralDynamics::Prepared prepared;
  CHECK(truth.Prepare(truth.Parameters(), &prepared, &error)) << error;
  Trajectory trajectory;
  CHECK(FreeRun(truth, prepared, ObservationMap(truth, observations),
                IntegrationGrid(*record.excitation, 4),
                Vector::Zero(truth.num_states()), 0, num_samples - 1,
                &trajectory));

  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (size_t c = 0; c < observations.size(); ++c) {
    MeasuredChannel channel;
    channel.observation = observations[c];
    channel.values = trajectory.channels.row(static_cast<int>(c));
    channel.sigma = kNoise * std::sqrt(channel.values.squaredNorm() /
                                       static_cast<double>(num_samples));
    for (double& value : channel.values)
      value += channel.sigma * normal(random);
    record.channels.push_back(channel);
  }

  IdentificationProblem problem;
  problem.dynamics = MakeChain(num_dofs, groups, true);
  problem.records.push_back(std::move(record));
  CHECK(problem.IsValid(&error)) << error;
  return problem;
}

}  // namespace benchmarks
}  // namespace pinode
