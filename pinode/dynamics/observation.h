// Measured channels as linear functions of state, acceleration and inputs.

#ifndef PINODE_DYNAMICS_OBSERVATION_H_
#define PINODE_DYNAMICS_OBSERVATION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Quantity that a channel measures. x, v, a: motion relative to the ground;
// a_g, x_g: acceleration and displacement of the ground; r: influence vectors.
enum class Quantity {
  kDisplacement,          // x
  kVelocity,              // v
  kRelativeAcceleration,  // a
  kAbsoluteAcceleration,  // a + r a_g
  kAbsoluteDisplacement,  // x + r x_g; needs the ground displacement as input
  kForce,                 // force on a DOF of prescribed motion
  kStrain,                // strain; see AxialStrain, BendingStrain
};

// Returns the name as in case files, such as "absolute_acceleration".
const char* QuantityName(Quantity quantity);
// Finds the quantity with this name. Returns false if there is none, and *error
// then lists the names.
[[nodiscard]] bool ParseQuantity(const std::string& name, Quantity* quantity,
                                 std::string* error);

// Channel: a linear combination of one quantity over the DOFs,
//
//   y = sum_i w_i quantity_i,
//
// in the model's units. A sensor at one DOF has one weight, 1. A strain gauge
// or a sensor of relative displacement has several. The weights of a strain
// make it dimensionless.
struct Observation {
  std::string name;
  Quantity quantity = Quantity::kDisplacement;
  Vector weights;  // one per DOF
};

// Return the weights (num_dofs) of a strain gauge with the length
// `gauge_length` > 0. sum_i c_i x_i, with `combination` c (num_dofs), is the
// difference of the displacements u, or rotations r, of its two ends:
//
//   axial, of displacements         (u_2 - u_1) / gauge_length,
//   bending, of rotations r = dv/dx  -distance (r_2 - r_1) / gauge_length
//
// The distance of the gauge from the neutral axis is `distance`, not 0. It is
// positive on the side of positive deflection v. The result is the mean strain
// over the gauge. All lengths are in the model's unit.
Vector AxialStrain(const Vector& combination, double gauge_length);
Vector BendingStrain(const Vector& combination, double distance,
                     double gauge_length);

// Channels of a record as linear maps of the state h, the acceleration a and
// the inputs u,
//
//   y = H_h h + H_a a(h, u; theta) + H_u u,
//
// a is the acceleration part of dh/dt. It depends on the parameters theta; the
// maps do not.
class ObservationMap {
 public:
  ObservationMap() = default;
  // Creates the maps. `observations` must fit the dynamics: as many weights as
  // DOFs, and the inputs that their quantities need.
  ObservationMap(const StructuralDynamics& dynamics,
                 const std::vector<Observation>& observations);

  int num_channels() const { return static_cast<int>(state_map_.rows()); }
  // True if a channel needs the acceleration.
  bool uses_acceleration() const { return !acceleration_rows_.empty(); }

  // Computes `y` (num_channels() entries) from the state, its rate (num_states
  // each) and the inputs (num_inputs) at one instant.
  void Observe(const double* state, const double* rate, const double* input,
               double* y) const;

  // Computes d y / d state, num_channels() x num_states, for the linearised
  // dynamics.
  void StateJacobian(const StructuralDynamics::Linearization& at,
                     Matrix* jacobian) const;

  // Indices of the channels that need the acceleration, and the map from the
  // rate of the state to them, acceleration_rows().size() x num_states. These
  // channels depend on the parameters directly, with the derivative rate_map()
  // * (d rate / d theta).
  const std::vector<int>& acceleration_rows() const {
    return acceleration_rows_;
  }
  const Matrix& rate_map() const { return rate_map_; }
  // Maps H_h (channels x states) and H_u (channels x inputs).
  const Matrix& state_map() const { return state_map_; }
  const Matrix& input_map() const { return input_map_; }

 private:
  void MapPrescribed(const StructuralDynamics& dynamics,
                     const Observation& observation, int channel);

  Matrix state_map_;      // channels x states
  Matrix full_rate_map_;  // channels x states, zero but for accelerations
  Matrix input_map_;      // channels x inputs
  std::vector<int> acceleration_rows_;
  Matrix rate_map_;
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_OBSERVATION_H_
