// The laws of a structure as one function of the few states that they use.

#ifndef PINODE_INTEGRATE_LOCAL_LAWS_H_
#define PINODE_INTEGRATE_LOCAL_LAWS_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// All elements and libraries of dynamics that contain only laws and constant
// groups. The results r are the laws' outputs, one after the other. They act on
// dv/dt through `output_map`. The internal states z follow displacements and
// velocities in the state h = [x; v; z].
class LocalLaws {
 public:
  explicit LocalLaws(const StructuralDynamics& dynamics);

  // Indices of displacements and velocities in h that the laws use, ascending.
  const std::vector<int>& states() const { return states_; }
  int num_outputs() const { return num_outputs_; }
  int num_internal() const { return num_internal_; }
  // Number of the laws' free parameters. Their tangent columns are the last
  // ones.
  int num_parameters() const { return num_parameters_; }

  // Returns the derivative of [0; dv/dt] with respect to r, (2 * num_dofs) x
  // num_outputs.
  Matrix OutputMap(const StructuralDynamics::Prepared& prepared) const;
  // Map from r to forces on the DOFs, num_dofs x num_outputs. Its sign is such
  // that the forces are added to the equation's right-hand side. Zero for laws
  // that act as an acceleration.
  const Matrix& forces() const { return forces_; }

  // Evaluates all laws. Reads only the entries of h that laws use. `results`
  // (num_outputs + num_internal): r and dz/dt.
  void Evaluate(const StructuralDynamics::Prepared& prepared, double time,
                const double* input, const double* state, double* results);
  // Does what Evaluate does, and computes the derivatives with respect to
  // states(), z and the laws' free parameters, (num_outputs + num_internal) x
  // (states + num_internal + num_parameters).
  void Linearize(const StructuralDynamics::Prepared& prepared, double time,
                 const double* input, const double* state, double* results,
                 Matrix* slopes);

 private:
  struct Place {
    int first_parameter = 0;  // in theta
    int first_internal = 0;   // among z
    int first_output = 0;
    // Columns of `slopes`, one per parameter; -1 for a fixed parameter.
    std::vector<int> parameter_columns;
    std::vector<double> parameter_factors;  // differ from 1 where tied
  };

  // Copies the law's results to their places.
  void Scatter(const LawTerm& term, const Place& place, double* results) const;

  const StructuralDynamics& dynamics_;
  std::vector<Place> places_;
  std::vector<int> states_;
  std::vector<int> column_of_state_;  // -1 if no law uses it
  Matrix forces_;
  int num_outputs_ = 0;
  int num_internal_ = 0;
  int num_parameters_ = 0;
  std::vector<double> features_;
  std::vector<double> own_;       // results of one law
  std::vector<double> jacobian_;  // of one law
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_LOCAL_LAWS_H_
