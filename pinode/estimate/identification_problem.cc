#include "pinode/estimate/identification_problem.h"

#include <algorithm>
#include <cmath>

namespace pinode {
namespace {

bool AnyFree(const ParameterBlock& block) {
  return std::any_of(block.parameters.begin(), block.parameters.end(),
                     [](const Parameter& p) { return p.free; });
}

}  // namespace

std::vector<int> IdentificationRecord::NoisyInputs() const {
  std::vector<int> inputs;
  for (int i = 0; i < input_sigma.size(); ++i) {
    if (input_sigma[i] > 0.0) inputs.push_back(i);
  }
  return inputs;
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
         kind == InputSpec::Kind::kForce) &&
        !record.excitation->samples().row(i).isZero(0.0)) {
      return true;
    }
  }
  return false;
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

bool IdentificationProblem::IsValid(std::string* error) const {
  if (dynamics == nullptr) {
    *error = "there is no model";
    return false;
  }
  StructuralDynamics::Prepared prepared;
  if (!description.IsValid(error) || !AreUnknownsValid(error) ||
      !dynamics->Prepare(dynamics->Parameters(), &prepared, error) ||
      !modal.IsValid(dynamics->num_dofs(), error)) {
    return false;
  }
  bool any_fitted = !modal.empty();
  for (const IdentificationRecord& record : records) {
    if (!IsRecordValid(record, error)) {
      *error = "record '" + record.name + "': " + *error;
      return false;
    }
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (const MeasuredChannel& channel : record.channels) {
      any_fitted = any_fitted || channel.fit;
    }
  }
  if (!any_fitted) {
    *error =
        "no training record has a fitted channel, and no mode was measured";
    return false;
  }
  return true;
}

bool IdentificationProblem::AreUnknownsValid(std::string* error) const {
  bool any_free = AnyFree(sensors);
  for (const ParameterBlock& block : dynamics->blocks()) {
    if (!block.IsValid(error)) return false;
    any_free = any_free || AnyFree(block);
  }
  if (!sensors.IsValid(error)) return false;
  if (!any_free) {
    *error =
        "no parameter is free: mark at least one group, element parameter, "
        "network or sensor parameter as free";
    return false;
  }
  if (modal.empty() || num_train_records() > 0) return true;
  for (const ParameterBlock& block : dynamics->blocks()) {
    if (block.name == "groups" || !AnyFree(block)) continue;
    *error = "modes tell of groups alone: '" + block.name +
             "' cannot be free without a training record";
    return false;
  }
  if (AnyFree(sensors)) {
    *error =
        "modes tell of groups alone: sensors cannot be free without a "
        "training record";
    return false;
  }
  return true;
}

bool IdentificationProblem::IsRecordValid(const IdentificationRecord& record,
                                          std::string* error) const {
  if (!record.excitation.has_value() || record.num_samples() < 2) {
    *error = "it has fewer than two samples";
    return false;
  }
  if (record.excitation->num_inputs() != dynamics->num_inputs()) {
    *error = "it has " + std::to_string(record.excitation->num_inputs()) +
             " inputs, the model has " + std::to_string(dynamics->num_inputs());
    return false;
  }
  if (!(record.sampling_step() > 0.0) ||
      !std::isfinite(record.sampling_step()) ||
      !record.excitation->samples().allFinite()) {
    *error = "its excitation holds a value, or has a step, that is not finite";
    return false;
  }
  if (record.input_sigma.size() != 0 &&
      (record.input_sigma.size() != dynamics->num_inputs() ||
       !record.input_sigma.allFinite() ||
       record.input_sigma.minCoeff() < 0.0)) {
    *error = "the noise of its inputs needs no value, or " +
             std::to_string(dynamics->num_inputs()) +
             " that are finite and not negative";
    return false;
  }
  if (record.substeps < 1) {
    *error =
        "it needs at least one Runge-Kutta step per sample; PrepareProblem "
        "chooses their number";
    return false;
  }
  if (record.start == IdentificationRecord::Start::kKnown &&
      (record.known_start.size() != dynamics->num_states() ||
       !record.known_start.allFinite())) {
    *error = "its start needs " + std::to_string(dynamics->num_states()) +
             " finite values, one per state";
    return false;
  }
  const double time_factor = record.description.time_factor;
  if (!(time_factor > 0.0) || !std::isfinite(time_factor)) {
    *error = "its unit of time has no positive factor";
    return false;
  }
  if (record.channels.empty()) {
    *error = "it has no measured channel";
    return false;
  }
  for (const MeasuredChannel& channel : record.channels) {
    if (IsChannelValid(record, channel, error)) continue;
    *error = "channel '" + channel.observation.name + "': " + *error;
    return false;
  }
  return true;
}

bool IdentificationProblem::IsChannelValid(const IdentificationRecord& record,
                                           const MeasuredChannel& channel,
                                           std::string* error) const {
  const Vector& weights = channel.observation.weights;
  if (weights.size() != dynamics->num_dofs() || !weights.allFinite()) {
    *error = "it needs " + std::to_string(dynamics->num_dofs()) +
             " finite weights, one per DOF";
    return false;
  }
  for (const int index : {channel.gain, channel.offset, channel.delay}) {
    if (index < -1 || index >= sensors.size()) {
      *error = "parameter " + std::to_string(index) +
               " of its sensor is none of the " +
               std::to_string(sensors.size()) + " there are (-1: ideal)";
      return false;
    }
  }
  if (channel.values.size() != record.num_samples()) {
    *error = "its length differs from that of the excitation";
    return false;
  }
  Eigen::Index num_present = 0;
  for (const double value : channel.values) {
    if (std::isinf(value)) {
      *error = "it holds an infinite value";
      return false;
    }
    if (std::isfinite(value)) ++num_present;
  }
  if (num_present == 0) {
    *error = "it holds no value";
    return false;
  }
  if (record.filter != nullptr && num_present != channel.values.size()) {
    *error = "a record with missing samples cannot be filtered";
    return false;
  }
  const double factor = channel.description.factor;
  if (factor == 0.0 || !std::isfinite(factor)) {
    *error = "the factor of its unit is zero or not finite";
    return false;
  }
  if (!(channel.sigma >= 0.0) || !std::isfinite(channel.sigma)) {
    *error = "its standard deviation is negative or not finite";
    return false;
  }
  return true;
}

}  // namespace pinode
