#include "pinode/estimate/identification_problem.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace pinode {

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
  if (!description.IsValid(error)) return false;
  bool any_free = false;
  for (const ParameterBlock& block : dynamics->blocks()) {
    if (!block.IsValid(error)) return false;
    for (const Parameter& p : block.parameters) any_free = any_free || p.free;
  }
  if (!sensors.IsValid(error)) return false;
  for (const Parameter& p : sensors.parameters) any_free = any_free || p.free;
  if (!any_free) {
    *error =
        "no parameter is free: mark at least one group, element parameter, "
        "network or sensor parameter as free";
    return false;
  }
  if (!modal.IsValid(dynamics->num_dofs(), error)) return false;
  if (!modal.empty() && num_train_records() == 0) {
    const auto has_free = [](const ParameterBlock& block) {
      return std::any_of(block.parameters.begin(), block.parameters.end(),
                         [](const Parameter& p) { return p.free; });
    };
    for (const ParameterBlock& block : dynamics->blocks()) {
      if (block.name == "groups" || !has_free(block)) continue;
      *error = "modes tell of groups alone: '" + block.name +
               "' cannot be free without a training record";
      return false;
    }
    if (has_free(sensors)) {
      *error =
          "modes tell of groups alone: sensors cannot be free without a "
          "training record";
      return false;
    }
  }
  bool any_fitted = !modal.empty();
  for (const IdentificationRecord& record : records) {
    const std::string prefix = "record '" + record.name + "': ";
    if (!record.excitation.has_value() || record.num_samples() < 2) {
      *error = prefix + "it has fewer than two samples";
      return false;
    }
    if (record.excitation->num_inputs() != dynamics->num_inputs()) {
      std::ostringstream message;
      message << "it has " << record.excitation->num_inputs()
              << " inputs, the model has " << dynamics->num_inputs();
      *error = prefix + message.str();
      return false;
    }
    if (record.substeps < 1) {
      *error = prefix +
               "it needs at least one Runge-Kutta step per sample; "
               "PrepareProblem chooses their number";
      return false;
    }
    if (record.start == IdentificationRecord::Start::kKnown &&
        (record.known_start.size() != dynamics->num_states() ||
         !record.known_start.allFinite())) {
      std::ostringstream message;
      message << "its start needs " << dynamics->num_states()
              << " finite values, one per state";
      *error = prefix + message.str();
      return false;
    }
    const double time_factor = record.description.time_factor;
    if (!(time_factor > 0.0) || !std::isfinite(time_factor)) {
      *error = prefix + "its unit of time has no positive factor";
      return false;
    }
    if (record.channels.empty()) {
      *error = prefix + "it has no measured channel";
      return false;
    }
    for (const MeasuredChannel& channel : record.channels) {
      const std::string where =
          prefix + "channel '" + channel.observation.name + "': ";
      if (channel.values.size() != record.num_samples()) {
        *error = where + "its length differs from that of the excitation";
        return false;
      }
      int finite = 0;
      for (double value : channel.values) {
        if (std::isinf(value)) {
          *error = where + "it holds an infinite value";
          return false;
        }
        finite += std::isfinite(value);
      }
      if (finite == 0) {
        *error = where + "it holds no value";
        return false;
      }
      if (record.filter != nullptr && finite != channel.values.size()) {
        *error = where + "a record with missing samples cannot be filtered";
        return false;
      }
      const double factor = channel.description.factor;
      if (factor == 0.0 || !std::isfinite(factor)) {
        *error = where + "the factor of its unit is zero or not finite";
        return false;
      }
      if (!(channel.sigma >= 0.0)) {
        *error = where + "its standard deviation is negative";
        return false;
      }
      any_fitted =
          any_fitted ||
          (channel.fit && record.role == IdentificationRecord::Role::kTrain);
    }
  }
  if (!any_fitted) {
    *error =
        "no training record has a fitted channel, and no mode was measured";
    return false;
  }
  return true;
}

}  // namespace pinode
