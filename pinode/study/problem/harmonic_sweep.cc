#include "pinode/study/problem/harmonic_sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/observation.h"
#include "pinode/integrate/periodic/response_curve.h"

namespace pinode {
namespace {

using Kind = InputSpec::Kind;

bool IsLoad(const InputSpec& input) {
  return input.kind == Kind::kForce || input.kind == Kind::kGroundAcceleration;
}

// Returns the index of the input of the load; -1, with *error, if there is
// none.
int FindLoad(const StructuralDynamics& dynamics, const std::string& name,
             std::string* error) {
  std::vector<std::string> loads;
  for (size_t i = 0; i < dynamics.inputs().size(); ++i) {
    const InputSpec& input = dynamics.inputs()[i];
    if (!IsLoad(input)) continue;
    if (input.name == name) return static_cast<int>(i);
    loads.push_back("'" + input.name + "'");
  }
  *error = "no load '" + name + "'; " +
           (loads.empty() ? "the case has no measured load"
                          : "the case has " + Join(loads, ", "));
  return -1;
}

bool IsValid(const HarmonicLoad& load, std::string* error) {
  // Far beyond what is measured, and what can be squared.
  constexpr double kLargest = 1e100;
  constexpr double kWidest = 1e6;
  constexpr int kMostPoints = 100000;
  if (!(load.amplitude > 1.0 / kLargest && load.amplitude < kLargest)) {
    *error = "the amplitude of a sweep is " + FormatNumber(load.amplitude) +
             ", expected a positive number";
    return false;
  }
  const double lower = std::min(load.from_hz, load.to_hz);
  const double upper = std::max(load.from_hz, load.to_hz);
  if (!(lower > 1.0 / kLargest && upper > lower && upper < kWidest * lower)) {
    *error =
        "a sweep has two different positive frequencies, the larger one at "
        "most a million times the other";
    return false;
  }
  if (load.num_points < 2 || load.num_points > kMostPoints) {
    *error = "a sweep has " + std::to_string(load.num_points) +
             " points, expected 2 to " + std::to_string(kMostPoints);
    return false;
  }
  return true;
}

// Responses of the channels at one point of the curve.
class Channels {
 public:
  Channels(const IdentificationProblem& problem,
           const IdentificationRecord& record, const Vector& parameters,
           HarmonicInput input, int load)
      : dynamics_(*problem.dynamics), input_(std::move(input)), load_(load) {
    std::vector<Observation> observations;
    factors_.resize(static_cast<Eigen::Index>(record.channels.size()));
    for (size_t i = 0; i < record.channels.size(); ++i) {
      const MeasuredChannel& channel = record.channels[i];
      observations.push_back(channel.observation);
      const double gain =
          channel.gain < 0
              ? 1.0
              : parameters[dynamics_.num_parameters() + channel.gain];
      factors_[static_cast<Eigen::Index>(i)] =
          gain / channel.description.factor;
    }
    map_ = ObservationMap(dynamics_, observations);
  }

  SweepPoint At(const PeriodicResponse& response) const {
    constexpr int kPhases = 512;
    const Matrix rates =
        DerivativeCoefficients(response.states, response.omega);
    // Channels are linear in state, rate and input.
    Matrix values(factors_.size(), response.states.cols());
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
      const Vector input = InputCoefficient(c, response.omega);
      map_.Observe(response.states.col(c).data(), rates.col(c).data(),
                   input.data(), values.col(c).data());
    }
    values = factors_.asDiagonal() * values;
    SweepPoint point;
    Vector lowest = ValueAt(values, 0.0);
    Vector highest = lowest;
    for (int j = 1; j < kPhases; ++j) {
      const Vector now = ValueAt(values, kTwoPi * j / kPhases);
      lowest = lowest.cwiseMin(now);
      highest = highest.cwiseMax(now);
    }
    point.half_range = 0.5 * (highest - lowest);
    point.amplitude = values.middleCols(1, 2).rowwise().norm();
    point.phase = values.col(1).binaryExpr(
        values.col(2),
        [](double cosine, double sine) { return std::atan2(-sine, cosine); });
    point.largest_multiplier = response.largest_multiplier;
    point.num_harmonics = static_cast<int>(response.states.cols()) / 2;
    point.neglected = response.neglected;
    return point;
  }

 private:
  // The inputs' mean for c = 0, their amplitude of the cosine for c = 1.
  Vector InputCoefficient(Eigen::Index c, double omega) const {
    if (c == 0) return input_.mean;
    Vector input = Vector::Zero(input_.mean.size());
    if (c > 1) return input;
    input = input_.amplitude;
    const std::vector<InputSpec>& inputs = dynamics_.inputs();
    const InputSpec& load = inputs[static_cast<size_t>(load_)];
    if (load.kind != Kind::kGroundAcceleration) return input;
    for (size_t i = 0; i < inputs.size(); ++i) {
      if (inputs[i].kind != Kind::kGroundDisplacement ||
          inputs[i].index != load.index) {
        continue;
      }
      input[static_cast<Eigen::Index>(i)] = -input[load_] / (omega * omega);
    }
    return input;
  }

  const StructuralDynamics& dynamics_;
  HarmonicInput input_;
  int load_;
  Vector factors_;
  ObservationMap map_;
};

}  // namespace

bool SweepRecord(const IdentificationProblem& problem, int record,
                 const Vector& parameters, const HarmonicLoad& load,
                 const std::function<bool(double)>& go_on,
                 std::vector<SweepPoint>* points, std::string* error) {
  points->clear();
  const StructuralDynamics& dynamics = *problem.dynamics;
  const IdentificationRecord& data =
      problem.records.at(static_cast<size_t>(record));
  if (!IsValid(load, error)) return false;
  const int index = FindLoad(dynamics, load.input, error);
  if (index < 0) return false;
  if (!dynamics.unknown_forces().empty()) {
    *error = "unknown force '" + dynamics.unknown_forces()[0].name +
             "' has a history of its own; take it out for a sweep";
    return false;
  }
  HarmonicInput input{Vector::Zero(dynamics.num_inputs()),
                      Vector::Zero(dynamics.num_inputs())};
  for (size_t i = 0; i < dynamics.inputs().size(); ++i) {
    const Kind kind = dynamics.inputs()[i].kind;
    if (kind != Kind::kCovariate && kind != Kind::kRecordSwitch) continue;
    const auto row = static_cast<Eigen::Index>(i);
    input.mean[row] = data.excitation->samples().row(row).mean();
  }
  input.amplitude[index] = load.amplitude;

  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(parameters.head(dynamics.num_parameters()), &prepared,
                        error)) {
    return false;
  }
  const auto balance =
      HarmonicBalance::Create(dynamics, prepared, input, error);
  if (balance == nullptr) return false;
  const double to_model = kTwoPi / problem.description.HzPerModelFrequency();
  ResponseCurveOptions options;
  options.from = load.from_hz * to_model;
  options.to = load.to_hz * to_model;
  options.num_points = load.num_points;
  const Channels channels(problem, data, parameters, input, index);
  options.each = [&](const PeriodicResponse& response) {
    SweepPoint point = channels.At(response);
    point.frequency_hz = response.omega / to_model;
    points->push_back(std::move(point));
    return !go_on || go_on(points->back().frequency_hz);
  };
  return FollowResponseCurve(options, balance.get(), error);
}

}  // namespace pinode
