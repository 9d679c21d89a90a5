// The map from one sample to the next for linear dynamics.

#ifndef PINODE_INTEGRATE_LINEAR_MAP_H_
#define PINODE_INTEGRATE_LINEAR_MAP_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/linear_rate.h"

namespace pinode {

// The map of an interval for dynamics with IsLinear,
//
//   dh/dt = F h + G u.
//
// A Runge-Kutta step is then a linear map of the state and of the inputs at its
// nodes, the same at every step. So are all steps of an interval together, and
// the exact solution for inputs that are polynomials there:
//
//   h(i + 1) = P h(i) + Q w(i),
//
// where w has the inputs at all nodes of the interval, in the order of
// IntegrationGrid::AtNode. With the derivatives P_j, Q_j with respect to the
// free parameters, the sensitivities S_j = d h / d theta_j follow
//
//   S_j(i + 1) = P S_j(i) + P_j h(i) + Q_j w(i).
//
// For Runge-Kutta these are the discrete steps and their exact derivatives.
// They cost two products of state size for each column and sample, for any
// number of steps per sample. For the exact solution they are those of
// ForcedExponential.
class LinearMap {
 public:
  // Computes the map, and its derivatives if requested.
  LinearMap(const StructuralDynamics& dynamics,
            const StructuralDynamics::Prepared& prepared,
            const IntegrationGrid& grid, bool with_parameters);

  // Returns the number of entries in the tables of derivatives, for estimates
  // of memory.
  static double TableSize(const StructuralDynamics& dynamics, int substeps);

  // [F G], num_states x (num_states + inputs).
  const Matrix& rate() const { return rate_; }
  // [F_j G_j] for the free parameters.
  const std::vector<Matrix>& rate_derivatives() const {
    return rate_derivatives_;
  }
  // P, num_states x num_states.
  const Matrix& transition() const { return transition_; }
  // Q, num_states x (3 * substeps * inputs).
  const Matrix& forcing() const { return forcing_; }
  // [P_j Q_j], stacked: (num_states * parameters) x (num_states + 3 * substeps
  // * inputs).
  const Matrix& derivatives() const { return derivatives_; }

 private:
  // Computes the steps from the rate's map and its derivatives.
  void ComputeSteps(const ParameterizedMap& rate, double step, int substeps);
  void ComputeExactly(const ParameterizedMap& rate, double sampling_step,
                      int substeps);

  Matrix rate_;
  std::vector<Matrix> rate_derivatives_;
  Matrix transition_;
  Matrix forcing_;
  Matrix derivatives_;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_LINEAR_MAP_H_
