// The laws of a structure as one function of the few states that they look at.

#ifndef PINODE_INTEGRATE_LOCAL_LAWS_H_
#define PINODE_INTEGRATE_LOCAL_LAWS_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// All elements and libraries of dynamics that have laws and constant groups and
// nothing else. The results r are the laws' outputs, one after the other, which
// act on dv/dt through `output_map`; the internal states z follow
// displacements and velocities in the state h = [x; v; z].
class LocalLaws {
 public:
  explicit LocalLaws(const StructuralDynamics& dynamics);

  // Indices of displacements and velocities in h that some law looks at,
  // ascending.
  const std::vector<int>& states() const { return states_; }
  int num_outputs() const { return num_outputs_; }
  int num_internal() const { return num_internal_; }
  // The tangent columns of the laws' parameters are the last ones.
  int num_parameters() const { return num_parameters_; }

  // [0; dv/dt] by r, (2 * num_dofs) x num_outputs.
  Matrix OutputMap(const StructuralDynamics::Prepared& prepared) const;
  // r's forces on the DOFs, num_dofs x num_outputs, with a sign such that they
  // add to the equation's right-hand side; zero where a law acts as an
  // acceleration.
  const Matrix& forces() const { return forces_; }

  // Of h only what laws look at is read. `results` (num_outputs +
  // num_internal): r and dz/dt.
  void Evaluate(const StructuralDynamics::Prepared& prepared, double time,
                const double* input, const double* state, double* results);
  // As Evaluate, with the derivatives by states(), z and the laws' free
  // parameters, (num_outputs + num_internal) x (states + num_internal +
  // num_parameters).
  void Linearize(const StructuralDynamics::Prepared& prepared, double time,
                 const double* input, const double* state, double* results,
                 Matrix* slopes);

 private:
  struct Place {
    int first_parameter = 0;  // in theta
    int first_internal = 0;   // among z
    int first_output = 0;
    // Of `slopes`, one a parameter; -1 where it is not free.
    std::vector<int> parameter_columns;
  };

  // The law's results to their places.
  void Scatter(const LawTerm& term, const Place& place, double* results) const;

  const StructuralDynamics& dynamics_;
  std::vector<Place> places_;
  std::vector<int> states_;
  std::vector<int> column_of_state_;  // -1 where no law looks
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
