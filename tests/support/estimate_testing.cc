#include "tests/support/estimate_testing.h"

#include <cmath>
#include <limits>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/dynamics/elements.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/integrate/free_run.h"
#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace testing {
namespace {

GroupTerm MakeGroup(const std::string& name, MatrixGroup::Target target,
                    const Matrix& matrix, double alpha) {
  GroupTerm term;
  term.group.name = name;
  term.group.target = target;
  term.group.matrix = matrix;
  term.alpha.name = name;
  term.alpha.value = alpha;
  return term;
}

}  // namespace

LawTerm MakeElement(const std::string& name, const std::string& type,
                    int num_dofs, int from, int to,
                    const std::vector<double>& values) {
  std::string error;
  LawTerm term;
  CHECK(pinode::MakeElement(name, type, num_dofs, from, to, values, &term,
                            &error))
      << error;
  return term;
}

std::shared_ptr<StructuralDynamics> MakeGroupedChain(int n, double k,
                                                     double c) {
  auto dynamics = std::make_shared<StructuralDynamics>(
      MakeChain(n, k, c),
      std::vector<InputSpec>{{InputSpec::Kind::kGroundAcceleration, 0, "ag"}});
  std::string error;
  for (int i = 0; i < n; ++i) {
    CHECK(dynamics->AddGroup(
        MakeGroup("k" + std::to_string(i + 1), MatrixGroup::Target::kStiffness,
                  k * SpringMatrix(n, i - 1, i), 0.0),
        &error))
        << error;
  }
  return dynamics;
}

std::shared_ptr<StructuralDynamics> MakeSmallNonlinear() {
  auto dynamics = std::make_shared<StructuralDynamics>(
      MakeChain(2, 20.0, 0.4),
      std::vector<InputSpec>{{InputSpec::Kind::kGroundAcceleration, 0, "ag"}});
  std::string error;
  using Target = MatrixGroup::Target;
  CHECK(dynamics->AddGroup(
      MakeGroup("k1", Target::kStiffness, 20.0 * SpringMatrix(2, -1, 0), 0.1),
      &error))
      << error;
  GroupTerm mass = MakeGroup("m2", Target::kMass,
                             Vector(Vector::Unit(2, 1)).asDiagonal(), 0.2);
  mass.alpha.free = false;
  CHECK(dynamics->AddGroup(std::move(mass), &error)) << error;
  CHECK(dynamics->AddGroup(
      MakeGroup("c2", Target::kDamping, SpringMatrix(2, 0, 1), 0.2), &error))
      << error;
  CHECK(dynamics->AddLaw(
      MakeElement("spring", "cubic", 2, Feature::kGround, 0, {8.0}), &error))
      << error;
  // k, a, b, g, n.
  LawTerm hysteresis =
      MakeElement("slip", "bouc_wen", 2, 0, 1, {3.0, 1.0, 0.8, 0.4, 2.0});
  hysteresis.parameters.parameters[4].free = false;
  CHECK(dynamics->AddLaw(std::move(hysteresis), &error)) << error;

  CHECK(dynamics->AddNetwork(
      MakeNetwork({Feature::Displacement(0), Feature::Velocity(1)}, 3, 0.5),
      &error))
      << error;
  return dynamics;
}

NetworkTerm MakeNetwork(std::vector<Feature> features, int hidden,
                        double input_scale) {
  NetworkArchitecture architecture;
  architecture.num_inputs = static_cast<int>(features.size());
  architecture.num_outputs = 1;
  architecture.hidden_widths = {hidden};
  architecture.input_scale =
      Vector::Constant(architecture.num_inputs, input_scale);
  NetworkTerm network;
  network.name = "net";
  network.network = std::make_shared<Network>(architecture);
  network.features = std::move(features);
  network.outputs = Matrix::Identity(2, 1);
  network.weights.name = "net";
  network.weights.named = false;
  network.weights.decays = architecture.NonlinearWeights();
  for (int i = 0; i < architecture.NumWeights(); ++i) {
    Parameter weight;
    weight.name = "net[" + std::to_string(i) + "]";
    weight.value = 0.5 * std::sin(1.7 * i + 0.3);
    network.weights.parameters.push_back(weight);
  }
  return network;
}

IdentificationRecord MakeExcitedRecord(const StructuralDynamics& dynamics,
                                       Eigen::Index samples, double step,
                                       Interpolation interpolation) {
  IdentificationRecord record;
  record.name = "shake";
  record.substeps = 1;
  Matrix inputs(dynamics.num_inputs(), samples);
  for (Eigen::Index i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) * step;
    for (int u = 0; u < inputs.rows(); ++u) {
      inputs(u, i) =
          0.7 * std::sin(3.1 * t + u) + 0.6 * std::sin(5.3 * t + 1.0) +
          0.5 * std::sin(8.9 * t + 2.0) + 0.3 * std::sin(14.3 * t + 0.4);
    }
  }
  record.excitation.emplace(0.0, step, inputs, interpolation);
  record.start = IdentificationRecord::Start::kRest;
  return record;
}

MeasuredChannel MakeChannel(const std::string& name, Quantity quantity,
                            int num_dofs, int dof) {
  MeasuredChannel channel;
  channel.observation.name = name;
  channel.observation.quantity = quantity;
  channel.observation.weights = Vector::Unit(num_dofs, dof);
  return channel;
}

Matrix Simulate(const StructuralDynamics& dynamics, const Vector& theta,
                const Vector& start, double noise, uint64_t seed,
                IdentificationRecord* record) {
  StructuralDynamics::Prepared prepared;
  std::string error;
  CHECK(dynamics.Prepare(theta, &prepared, &error)) << error;
  std::vector<Observation> observations;
  for (const MeasuredChannel& channel : record->channels) {
    observations.push_back(channel.observation);
  }
  const ObservationMap observation(dynamics, observations);
  const IntegrationGrid grid(*record->excitation, record->substeps);
  Trajectory trajectory;
  CHECK(FreeRun(dynamics, prepared, observation, grid, start, 0,
                record->num_samples() - 1, &trajectory));
  Gaussian random(seed);
  for (size_t c = 0; c < record->channels.size(); ++c) {
    Vector values = trajectory.channels.row(static_cast<int>(c));
    const double size = noise * StandardDeviationOfPresent(values);
    values += size * random.Draw(record->num_samples());
    record->channels[c].values = values;
  }
  return trajectory.states;
}

MeasuredMode MakeMeasuredMode(double frequency, std::vector<int> dofs,
                              std::vector<double> shape) {
  MeasuredMode mode;
  mode.name = "m";
  mode.frequency = frequency;
  mode.dofs = std::move(dofs);
  mode.shape =
      Eigen::Map<const Vector>(shape.data(), static_cast<int>(shape.size()));
  return mode;
}

Vector Differentiate(const std::function<Vector(double)>& function, double h) {
  const auto central = [&function](double step) -> Vector {
    return (function(step) - function(-step)) / (2.0 * step);
  };
  const Vector d0 = central(h);
  const Vector d1 = central(0.5 * h);
  const Vector d2 = central(0.25 * h);
  const Vector e0 = (4.0 * d1 - d0) / 3.0;
  const Vector e1 = (4.0 * d2 - d1) / 3.0;
  return (16.0 * e1 - e0) / 15.0;
}

SmallFit::SmallFit(IdentificationRecord::Start start) {
  auto dynamics = MakeSmallNonlinear();
  const int ns = dynamics->num_states();
  const Vector truth = dynamics->Parameters();
  const auto add_sensor = [this](const std::string& name, double value) {
    Parameter parameter;
    parameter.name = name;
    parameter.value = value;
    problem.sensors.parameters.push_back(parameter);
  };
  problem.sensors.name = "sensors";
  add_sensor("gain.a2", 1.1);
  add_sensor("offset.x1", 0.05);
  add_sensor("delay.v2", 0.017);
  problem.sensors.parameters[0].prior_mean = 1.0;
  problem.sensors.parameters[0].prior_sigma = 0.05;

  for (int r = 0; r < 2; ++r) {
    IdentificationRecord record =
        MakeExcitedRecord(*dynamics, r == 0 ? 31 : 24, 0.05);
    record.name = "r" + std::to_string(r + 1);
    record.substeps = r + 1;
    record.channels = {MakeChannel("x1", Quantity::kDisplacement, 2, 0),
                       MakeChannel("a2", Quantity::kAbsoluteAcceleration, 2, 1),
                       MakeChannel("v2", Quantity::kVelocity, 2, 1),
                       MakeChannel("x2", Quantity::kDisplacement, 2, 1)};
    Vector first = Vector::Zero(ns);
    if (start != IdentificationRecord::Start::kRest) {
      first = 0.1 * Vector::LinSpaced(ns, -1.0, 1.0 + r);
    }
    states.push_back(Simulate(*dynamics, truth, first, 0.1,
                              static_cast<uint64_t>(10 + r), &record));
    record.start = start;
    record.known_start = first;
    record.channels[0].offset = 1;
    record.channels[1].gain = 0;
    record.channels[2].delay = 2;
    record.channels[3].fit = false;
    record.channels[0].values[4] = std::numeric_limits<double>::quiet_NaN();
    record.channels[2].values[11] = std::numeric_limits<double>::quiet_NaN();
    Vector sigma(4);
    for (int c = 0; c < 4; ++c) {
      sigma[c] = 0.1 * StandardDeviationOfPresent(
                           record.channels[static_cast<size_t>(c)].values);
    }
    sigmas.push_back(sigma);
    scales.push_back(Vector::LinSpaced(ns, 0.1, 0.4));
    problem.records.push_back(std::move(record));
  }
  // All but the factor of the hysteresis' shape.
  Vector theta = truth;
  int index = 0;
  int moved = 0;
  for (const ParameterBlock& block : dynamics->blocks()) {
    for (const Parameter& parameter : block.parameters) {
      if (parameter.name != "slip.beta") {
        theta[index] *= 1.0 + 0.05 * std::cos(2.3 * moved++);
      }
      ++index;
    }
  }
  dynamics->SetParameters(theta);
  problem.dynamics = dynamics;
  layout = std::make_unique<ParameterLayout>(problem);
  free = layout->Free(layout->InitialValues());
  decays = Vector::LinSpaced(layout->num_decay_groups(), 0.3, 2.0);
}

std::unique_ptr<Objective> SmallFit::Shoot(
    Eigen::Index segment_samples,
    const MultipleShooting::Options& options) const {
  auto objective = std::make_unique<Objective>(problem, *layout, options);
  SetSegments(segment_samples, states, &objective->shooting());
  objective->shooting().SetSigmas(sigmas);
  objective->shooting().SetStateScales(scales);
  objective->shooting().SetGapPenalty(7.0);
  objective->priors().SetDecays(decays);
  return objective;
}

}  // namespace testing
}  // namespace pinode
