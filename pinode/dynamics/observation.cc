#include "pinode/dynamics/observation.h"

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

struct NamedQuantity {
  Quantity quantity;
  const char* name;
};

constexpr NamedQuantity kQuantities[] = {
    {Quantity::kDisplacement, "displacement"},
    {Quantity::kVelocity, "velocity"},
    {Quantity::kRelativeAcceleration, "relative_acceleration"},
    {Quantity::kAbsoluteAcceleration, "absolute_acceleration"},
    {Quantity::kAbsoluteDisplacement, "absolute_displacement"},
    {Quantity::kForce, "force"},
    {Quantity::kStrain, "strain"},
};

}  // namespace

const char* QuantityName(Quantity quantity) {
  for (const NamedQuantity& entry : kQuantities) {
    if (entry.quantity == quantity) return entry.name;
  }
  return "";
}

bool ParseQuantity(const std::string& name, Quantity* quantity,
                   std::string* error) {
  std::vector<std::string> names;
  for (const NamedQuantity& entry : kQuantities) {
    if (name == entry.name) {
      *quantity = entry.quantity;
      return true;
    }
    names.emplace_back(entry.name);
  }
  const std::string nearest = NearestName(name, names);
  *error = "unknown quantity '" + name + "', expected one of " +
           Join(names, ", ") +
           (nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
  return false;
}

Vector AxialStrain(const Vector& combination, double gauge_length) {
  CHECK_GT(gauge_length, 0.0);
  return combination / gauge_length;
}

Vector BendingStrain(const Vector& combination, double distance,
                     double gauge_length) {
  CHECK_NE(distance, 0.0);
  return -distance * AxialStrain(combination, gauge_length);
}

ObservationMap::ObservationMap(const StructuralDynamics& dynamics,
                               const std::vector<Observation>& observations) {
  const int n = dynamics.num_dofs();
  const int channels = static_cast<int>(observations.size());
  state_map_ = Matrix::Zero(channels, dynamics.num_states());
  full_rate_map_ = Matrix::Zero(channels, dynamics.num_states());
  input_map_ = Matrix::Zero(channels, dynamics.num_inputs());
  for (int c = 0; c < channels; ++c) {
    const Observation& observation = observations[static_cast<size_t>(c)];
    CHECK_EQ(observation.weights.size(), n)
        << "channel '" << observation.name << "' needs one weight per DOF";
    const auto weights = observation.weights.transpose();
    const bool acceleration =
        observation.quantity == Quantity::kRelativeAcceleration ||
        observation.quantity == Quantity::kAbsoluteAcceleration ||
        observation.quantity == Quantity::kForce;
    if (acceleration) {
      full_rate_map_.block(c, n, 1, n) = weights;
      acceleration_rows_.push_back(c);
    } else if (observation.quantity == Quantity::kVelocity) {
      state_map_.block(c, n, 1, n) = weights;
    } else {
      state_map_.block(c, 0, 1, n) = weights;
    }
    if (acceleration) MapPrescribed(dynamics, observation, c);
    // Motion of the ground, which absolute sensors include.
    for (int i = 0; i < dynamics.num_inputs(); ++i) {
      const InputSpec& input = dynamics.inputs()[static_cast<size_t>(i)];
      if ((observation.quantity == Quantity::kAbsoluteAcceleration &&
           input.kind == InputSpec::Kind::kGroundAcceleration) ||
          (observation.quantity == Quantity::kAbsoluteDisplacement &&
           input.kind == InputSpec::Kind::kGroundDisplacement)) {
        input_map_(c, i) =
            weights.dot(dynamics.model().influence.col(input.index));
      }
    }
  }
  rate_map_ = Matrix::Zero(static_cast<int>(acceleration_rows_.size()),
                           dynamics.num_states());
  for (size_t r = 0; r < acceleration_rows_.size(); ++r) {
    rate_map_.row(static_cast<int>(r)) =
        full_rate_map_.row(acceleration_rows_[r]);
  }
}

// The rate at a prescribed DOF is the acceleration that it would have without
// the prescription.
void ObservationMap::MapPrescribed(const StructuralDynamics& dynamics,
                                   const Observation& observation,
                                   int channel) {
  for (const PrescribedDof& p : dynamics.prescribed()) {
    const double weight = observation.weights[p.dof];
    double& rate = full_rate_map_(channel, dynamics.num_dofs() + p.dof);
    double& input = input_map_(channel, p.acceleration);
    if (observation.quantity == Quantity::kForce) {
      input = weight * dynamics.model().mass(p.dof, p.dof);
      rate = -input;
    } else {
      input = weight;
      rate = 0.0;
    }
  }
}

void ObservationMap::Observe(const double* state, const double* rate,
                             const double* input, double* y) const {
  Eigen::Map<Vector> channels(y, num_channels());
  const Eigen::Index states = state_map_.cols();
  channels.noalias() = state_map_ * Eigen::Map<const Vector>(state, states);
  if (uses_acceleration()) {
    channels.noalias() +=
        full_rate_map_ * Eigen::Map<const Vector>(rate, states);
  }
  if (input_map_.cols() > 0) {
    channels.noalias() +=
        input_map_ * Eigen::Map<const Vector>(input, input_map_.cols());
  }
}

void ObservationMap::StateJacobian(const StructuralDynamics::Linearization& at,
                                   Matrix* jacobian) const {
  *jacobian = state_map_;
  if (uses_acceleration()) {
    jacobian->noalias() += full_rate_map_ * at.jacobian;
  }
}

}  // namespace pinode
