#include "pinode/problem/identification_problem.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "pinode/base/parameter_block.h"

namespace pinode {
namespace {

// Largest absolute sample: sums of squares of larger ones are not finite.
constexpr double kLargestSample = 1e140;

bool HasFree(const ParameterBlock& block) {
  return std::any_of(block.parameters.begin(), block.parameters.end(),
                     [](const Parameter& parameter) { return parameter.free; });
}

// Modes without a record can determine groups only.
bool AreGroupsAloneFree(const IdentificationProblem& problem,
                        std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  for (int b = 0; b < dynamics.num_terms(); ++b) {
    const ParameterBlock& block = dynamics.blocks()[static_cast<size_t>(b)];
    const TermKind kind = dynamics.term(b).kind();
    if (kind == TermKind::kGroups || !HasFree(block) ||
        (kind == TermKind::kGroupCurve &&
         (!problem.ambient.empty() || problem.modal.inputs.size() > 0))) {
      continue;
    }
    *error =
        "modes, ambient records and frequency response functions determine "
        "only groups: '" +
        block.name + "' cannot be free without a training record" +
        (kind == TermKind::kGroupCurve ? ", or covariates of the measured modes"
                                       : "");
    return false;
  }
  if (HasFree(problem.sensors) && problem.frfs.empty()) {
    *error =
        "modes and ambient records determine only groups: sensors cannot be "
        "free without a training record";
    return false;
  }
  return true;
}

bool HasGroundDisplacement(const StructuralDynamics& dynamics) {
  return std::any_of(dynamics.inputs().begin(), dynamics.inputs().end(),
                     [](const InputSpec& input) {
                       return input.kind ==
                              InputSpec::Kind::kGroundDisplacement;
                     });
}

bool IsOnPrescribed(const StructuralDynamics& dynamics, Vector weights) {
  for (const PrescribedDof& p : dynamics.prescribed()) weights[p.dof] = 0.0;
  return weights.isZero(0.0);
}

bool IsValidObservation(const StructuralDynamics& dynamics,
                        const Observation& observation, std::string* error) {
  std::ostringstream message;
  if (observation.weights.size() != dynamics.num_dofs()) {
    message << "it has " << observation.weights.size()
            << " weights, the model has " << dynamics.num_dofs() << " DOFs";
  } else if (!observation.weights.allFinite()) {
    message << "a weight of its DOFs is not finite";
  } else if (observation.quantity == Quantity::kAbsoluteDisplacement &&
             !HasGroundDisplacement(dynamics)) {
    message << "an absolute displacement needs the ground displacement among "
               "the inputs";
  } else if (observation.quantity == Quantity::kForce &&
             !IsOnPrescribed(dynamics, observation.weights)) {
    message << "a force is measured where the motion is prescribed; expected "
               "weights at such DOFs only";
  } else {
    return true;
  }
  *error = message.str();
  return false;
}

bool AreValidSensors(const IdentificationProblem& problem,
                     const MeasuredChannel& channel, std::string* error) {
  const struct {
    const char* name;
    int index;
  } sensors[] = {{"gain", channel.gain},
                 {"offset", channel.offset},
                 {"delay", channel.delay}};
  for (const auto& sensor : sensors) {
    if (sensor.index >= -1 && sensor.index < problem.sensors.size()) continue;
    *error = std::string("its ") + sensor.name + " is sensor parameter " +
             std::to_string(sensor.index) + ", the problem has " +
             std::to_string(problem.sensors.size());
    return false;
  }
  return true;
}

bool AreValidSamples(const IdentificationRecord& record,
                     const MeasuredChannel& channel, std::string* error) {
  Eigen::Index finite = 0;
  bool any_infinite = false;
  bool any_huge = false;
  for (const double value : channel.values) {
    any_infinite = any_infinite || std::isinf(value);
    any_huge = any_huge || std::abs(value) > kLargestSample;
    finite += std::isfinite(value);
  }
  if (channel.values.size() != record.num_samples()) {
    *error = "its length differs from that of the excitation";
  } else if (any_infinite) {
    *error = "it holds an infinite value";
  } else if (any_huge) {
    *error = "it holds a value beyond 1e140, expected one that can be measured";
  } else if (finite == 0) {
    *error = "it holds no value";
  } else if (record.filter != nullptr && finite != channel.values.size()) {
    *error = "a record with missing samples cannot be filtered";
  } else if (channel.description.factor == 0.0 ||
             !std::isfinite(channel.description.factor)) {
    *error = "the factor of its unit is zero or not finite";
  } else if (!(channel.sigma >= 0.0)) {
    *error = "its standard deviation is negative";
  } else if (std::isinf(channel.sigma)) {
    *error = "its standard deviation is not finite";
  } else {
    return true;
  }
  return false;
}

bool IsValidExcitation(const StructuralDynamics& dynamics,
                       const IdentificationRecord& record, std::string* error) {
  std::ostringstream message;
  if (!record.excitation.has_value() || record.num_samples() < 2) {
    message << "it has fewer than two samples";
  } else if (record.excitation->num_inputs() != dynamics.num_inputs()) {
    message << "it has " << record.excitation->num_inputs()
            << " inputs, the model has " << dynamics.num_inputs();
  } else if (!(record.sampling_step() > 0.0) ||
             !std::isfinite(record.sampling_step()) ||
             !record.excitation->samples().allFinite()) {
    message << "its excitation holds a value, or has a step, that is not "
               "finite";
  } else if ((record.excitation->samples().array().abs() > kLargestSample)
                 .any()) {
    message << "its excitation holds a value beyond 1e140, expected one that "
               "can be measured";
  } else if (record.input_sigma.size() != 0 &&
             record.input_sigma.size() != dynamics.num_inputs()) {
    message << "it has " << record.input_sigma.size()
            << " standard deviations of inputs, the model has "
            << dynamics.num_inputs() << " inputs";
  } else if (!record.input_sigma.allFinite() ||
             !(record.input_sigma.array() >= 0.0).all()) {
    message << "the standard deviation of an input is negative or not finite";
  } else if (record.substeps < 1) {
    message << "it needs at least one Runge-Kutta step per sample; "
               "PrepareProblem chooses their number";
  } else if (record.start == IdentificationRecord::Start::kKnown &&
             (record.known_start.size() != dynamics.num_states() ||
              !record.known_start.allFinite())) {
    message << "its start needs " << dynamics.num_states()
            << " finite values, one per state";
  } else if (record.start_samples < 0 ||
             record.start_samples > record.num_samples()) {
    message << "its start is to be found from " << record.start_samples
            << " samples, it has " << record.num_samples();
  } else if (!(record.description.time_factor > 0.0) ||
             !std::isfinite(record.description.time_factor)) {
    message << "its unit of time has no positive factor";
  } else {
    return true;
  }
  *error = message.str();
  return false;
}

// Checks a record; on failure *error lacks the record's name.
bool IsValidRecord(const IdentificationProblem& problem,
                   const IdentificationRecord& record, std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  if (!IsValidExcitation(dynamics, record, error)) return false;
  if (record.channels.empty()) {
    *error = "it has no measured channel";
    return false;
  }
  for (const MeasuredChannel& channel : record.channels) {
    std::string what;
    if (AreValidSamples(record, channel, &what) &&
        IsValidObservation(dynamics, channel.observation, &what) &&
        AreValidSensors(problem, channel, &what)) {
      continue;
    }
    *error = "channel '" + channel.observation.name + "': " + what;
    return false;
  }
  return true;
}

}  // namespace

std::vector<int> IdentificationRecord::NoisyInputs() const {
  std::vector<int> inputs;
  for (int i = 0; i < input_sigma.size(); ++i) {
    if (input_sigma[i] > 0.0) inputs.push_back(i);
  }
  return inputs;
}

std::vector<Observation> IdentificationRecord::Observations() const {
  std::vector<Observation> observations;
  for (const MeasuredChannel& channel : channels) {
    observations.push_back(channel.observation);
  }
  return observations;
}

std::vector<const ParameterBlock*> IdentificationProblem::ParameterBlocks()
    const {
  std::vector<const ParameterBlock*> blocks;
  for (const ParameterBlock& block : dynamics->blocks()) {
    blocks.push_back(&block);
  }
  blocks.push_back(&sensors);
  return blocks;
}

int IdentificationProblem::num_train_records() const {
  int count = 0;
  for (const IdentificationRecord& record : records) {
    if (record.role == IdentificationRecord::Role::kTrain) ++count;
  }
  return count;
}

bool IdentificationProblem::IsDriven(const IdentificationRecord& record) const {
  for (int i = 0; i < dynamics->num_inputs(); ++i) {
    const InputSpec::Kind kind =
        dynamics->inputs()[static_cast<size_t>(i)].kind;
    if ((kind == InputSpec::Kind::kGroundAcceleration ||
         kind == InputSpec::Kind::kForce ||
         kind == InputSpec::Kind::kPrescribedDisplacement) &&
        !record.excitation->samples().row(i).isZero(0.0)) {
      return true;
    }
  }
  return false;
}

double IdentificationProblem::InitialGain(
    const MeasuredChannel& channel) const {
  const double gain =
      channel.gain < 0
          ? 1.0
          : sensors.parameters[static_cast<size_t>(channel.gain)].value;
  return gain == 0.0 ? 1.0 : gain;
}

IdentificationRecord IdentificationProblem::AsSeenByIdealSensors(
    const IdentificationRecord& record) const {
  IdentificationRecord ideal = record;
  for (MeasuredChannel& channel : ideal.channels) {
    const double gain = InitialGain(channel);
    channel.values /= gain;
    channel.sigma /= std::abs(gain);
  }
  return ideal;
}

std::string IdentificationProblem::UnitOf(
    const MeasuredChannel& channel) const {
  return channel.description.unit.empty()
             ? UnitName(DimensionOf(channel.observation.quantity),
                        description.units)
             : channel.description.unit;
}

std::string IdentificationProblem::LocationOf(
    const MeasuredChannel& channel) const {
  return channel.description.location.empty()
             ? LocationText(channel.observation.weights,
                            dynamics->model().dof_names)
             : channel.description.location;
}

bool IdentificationProblem::HasValidTies(std::string* parameter,
                                         std::string* error) const {
  if (!AreTiesValid(ParameterBlocks(), parameter, error)) return false;
  for (const ParameterBlock& block : dynamics->blocks()) {
    for (const Parameter& tied : block.parameters) {
      const auto is_source = [&tied](const Parameter& sensor) {
        return sensor.name == tied.tie;
      };
      if (!tied.IsTied() || std::none_of(sensors.parameters.begin(),
                                         sensors.parameters.end(), is_source)) {
        continue;
      }
      *parameter = tied.name;
      *error = "it is tied to '" + tied.tie +
               "' of a sensor; let the sensor's unknown follow this one";
      return false;
    }
  }
  return true;
}

bool IdentificationProblem::IsValid(std::string* error) const {
  if (dynamics == nullptr) {
    *error = "there is no model";
    return false;
  }
  bool any_free = false;
  for (const ParameterBlock& block : dynamics->blocks()) {
    if (!block.IsValid(error)) return false;
    any_free = any_free || HasFree(block);
  }
  if (!sensors.IsValid(error)) return false;
  std::string tied;
  if (!HasValidTies(&tied, error)) {
    *error = "parameter '" + tied + "': " + *error;
    return false;
  }
  any_free = any_free || HasFree(sensors);
  if (!any_free) {
    *error =
        "no parameter is free: mark at least one group, element parameter, "
        "network or sensor parameter as free";
    return false;
  }
  StructuralDynamics::Prepared prepared;
  if (!description.IsValid(error) ||
      !dynamics->Prepare(dynamics->Parameters(), &prepared, error) ||
      !modal.IsValid(dynamics->num_dofs(), error)) {
    return false;
  }
  if (modal.inputs.size() > 0 &&
      (modal.inputs.size() != dynamics->num_inputs() ||
       !modal.inputs.allFinite())) {
    *error =
        "covariates of measured modes need a finite number for each input of "
        "the model";
    return false;
  }
  for (const AmbientRecord& record : ambient) {
    if (!record.IsValid(*dynamics, error)) return false;
  }
  for (const FrfRecord& record : frfs) {
    if (!record.IsValid(*dynamics, sensors.size(), error)) return false;
  }
  const bool alone = !modal.empty() || HasSpectra();
  if (alone && num_train_records() == 0 && !AreGroupsAloneFree(*this, error)) {
    return false;
  }
  bool any_fitted = alone;
  for (const IdentificationRecord& record : records) {
    std::string what;
    if (!IsValidRecord(*this, record, &what)) {
      *error = "record '" + record.name + "': " + what;
      return false;
    }
    const bool train = record.role == IdentificationRecord::Role::kTrain;
    for (const MeasuredChannel& channel : record.channels) {
      any_fitted = any_fitted || (train && channel.fit);
    }
  }
  if (!any_fitted) {
    *error =
        "no training record has a fitted channel, no mode was measured, and "
        "there is no ambient record or frequency response function";
    return false;
  }
  return true;
}

}  // namespace pinode
