// Measured channels as functions of the state.

#ifndef PINODE_DYNAMICS_OBSERVATION_H_
#define PINODE_DYNAMICS_OBSERVATION_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

enum class Quantity {
  kDisplacement,          // x, relative to the ground
  kVelocity,              // v, relative to the ground
  kRelativeAcceleration,  // a
  kAbsoluteAcceleration,  // a + r a_g
  kAbsoluteDisplacement,  // x + r x_g; needs the ground displacement as input
  kForce,                 // force on a DOF of prescribed motion
  kStrain,                // of x, see AxialStrain and BendingStrain
};

// Returns the name as in case files, "displacement" and so on.
const char* QuantityName(Quantity quantity);
[[nodiscard]] bool ParseQuantity(const std::string& name, Quantity* quantity,
                                 std::string* error);

// One channel: a linear combination of one quantity over the DOFs,
//
//   y = sum_i w_i quantity_i,
//
// in the model's units. A sensor at one DOF has one weight 1. A strain gauge or
// a relative displacement sensor has several. The weights of a strain make it
// dimensionless.
struct Observation {
  std::string name;
  Quantity quantity = Quantity::kDisplacement;
  Vector weights;  // num_dofs
};

// Return the weights of a strain gauge. Its ends move apart by sum_i c_i x_i,
// with `combination` c (num_dofs), over its `gauge_length` > 0:
//
//   axial, of displacements         (u_2 - u_1) / gauge_length,
//   bending, of rotations r = dv/dx  -distance (r_2 - r_1) / gauge_length
//
// where `distance`, not 0, is the distance from the neutral axis, positive on
// the side of positive deflection v. The result is the mean strain over the
// gauge.
Vector AxialStrain(const Vector& combination, double gauge_length);
Vector BendingStrain(const Vector& combination, double distance,
                     double gauge_length);

// All channels of a record as linear maps of state, acceleration and inputs,
//
//   y = H_h h + H_a a(h, u; theta) + H_u u,
//
// where a is the acceleration part of dh/dt. The maps do not depend on the
// parameters; a does.
class ObservationMap {
 public:
  ObservationMap() = default;
  ObservationMap(const StructuralDynamics& dynamics,
                 const std::vector<Observation>& observations);

  int num_channels() const { return static_cast<int>(state_map_.rows()); }
  // Returns true if some channel needs the acceleration.
  bool uses_acceleration() const { return !acceleration_rows_.empty(); }

  // Computes y (num_channels) from the state and its rate at one instant.
  void Observe(const double* state, const double* rate, const double* input,
               double* y) const;

  // Computes d y / d state for the linearised dynamics, num_channels x
  // num_states.
  void StateJacobian(const StructuralDynamics::Linearization& at,
                     Matrix* jacobian) const;

  // Rows of the channels with accelerations, and the map from the rate of the
  // state to them (acceleration rows x num_states). The parameters' direct
  // effect on the channels is rate_map * (d rate / d theta).
  const std::vector<int>& acceleration_rows() const {
    return acceleration_rows_;
  }
  const Matrix& rate_map() const { return rate_map_; }
  // H_h and H_u.
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
