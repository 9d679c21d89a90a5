// One Runge-Kutta step together with its exact derivative.

#ifndef PINODE_INTEGRATE_TANGENT_STEP_H_
#define PINODE_INTEGRATE_TANGENT_STEP_H_

#include <array>
#include <optional>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/switched_step.h"

namespace pinode {

// Propagates a state h and its sensitivities S = d h / d (start, theta),
// num_states x (num_states + num_tangent_columns), over one RK4 step. With
// stages k_s = f(X_s), J_s = df/dh and F_s = df/dtheta at stage s,
//
//   G4 = dt/6 I                      G3 = dt/3 I + dt   G4 J4
//   G2 = dt/3 I + dt/2 G3 J3         G1 = dt/6 I + dt/2 G2 J2
//   A  = I + sum_s G_s J_s           B  = sum_s G_s F_s
//   S(t + dt) = A S(t) + [0 B]
//
// which is the derivative of the discrete step itself (pinode/theory). If S
// has few columns relative to its states, it is instead carried through the
// stages,
//
//   S_1 = S   S_2 = S + dt/2 K_1   S_3 = S + dt/2 K_2   S_4 = S + dt K_3
//   K_s = J_s S_s + [0 F_s],   S(t + dt) = S + dt/6 (K_1 + 2 K_2 + 2 K_3 + K_4)
//
// which gives the same result without products of state size. After
// construction no function allocates memory. Use one object per thread.
class TangentStep {
 public:
  explicit TangentStep(const StructuralDynamics& dynamics);

  // Prepares for steps from a state, the first one of a segment. It matters for
  // dynamics with switches alone.
  void Begin(const StructuralDynamics::Prepared& prepared, double time,
             const double* input, const double* state);

  // Returns the dynamics linearised at a sample, for observation and as the
  // first stage of the step that starts there.
  const StructuralDynamics::Linearization& LinearizeAt(
      const StructuralDynamics::Prepared& prepared, double time,
      const double* input, const double* state);

  // Advances *state (num_states) and *sensitivity by one step. `linearized` is
  // true if the last call was LinearizeAt at *state and the beginning of the
  // step. `with_parameters` is true if the last columns of *sensitivity are
  // those of the parameters.
  void Step(const StructuralDynamics::Prepared& prepared,
            const IntegrationGrid& grid, Eigen::Index interval, int substep,
            bool linearized, bool with_parameters, Vector* state,
            Matrix* sensitivity);

  // Computes result (rows x num_tangent_columns) += left * (df/dtheta) at the
  // point of the last LinearizeAt, before the next step. left is rows x
  // num_states.
  void AddParameterTangents(const StructuralDynamics::Prepared& prepared,
                            const Matrix& left, Matrix* result);

 private:
  // One step, or a piece of one, and the inputs at its nodes.
  struct Span {
    double time = 0.0;
    double duration = 0.0;
    const double* begin = nullptr;
    const double* middle = nullptr;
    const double* end = nullptr;
  };
  void StepOver(const StructuralDynamics::Prepared& prepared, const Span& span,
                bool linearized, bool with_parameters, Vector* state,
                Matrix* sensitivity);
  // Performs a step piece by piece, see SwitchedStep.
  void StepInPieces(const StructuralDynamics::Prepared& prepared,
                    const IntegrationGrid& grid, Eigen::Index interval,
                    int substep, bool with_parameters, Vector* state,
                    Matrix* sensitivity);
  void SetBranches(const char* branches);
  // Compute next_ from the linearised stages, by the transition A or through
  // the stages.
  void AdvanceByTransition(const StructuralDynamics::Prepared& prepared,
                           double dt, bool with_parameters,
                           const Matrix& sensitivity);
  void AdvanceThroughStages(const StructuralDynamics::Prepared& prepared,
                            double dt, bool with_parameters,
                            const Matrix& sensitivity);
  // Adds the parameters' columns to next_, for the stages and weights of a
  // step.
  void AddParameterColumns(const StructuralDynamics::Prepared& prepared);

  const StructuralDynamics& dynamics_;
  std::array<StructuralDynamics::Linearization, 4> stages_;
  std::array<Matrix, 4> weights_;  // G_1 ... G_4
  StructuralDynamics::TangentScratch scratch_;
  StructuralDynamics::TangentScratch observation_scratch_;
  Matrix transition_;  // A
  Matrix product_;     // G_s J_s
  Matrix next_;        // next sensitivity
  // Scratch of the stages: S_s, K_s, and F_s without the rates of
  // displacements.
  StructuralDynamics::TangentScratch forward_scratch_;
  Matrix lower_;  // takes the rows of F_s
  Matrix stage_sensitivity_;
  Matrix stage_rate_;
  Matrix parameter_rate_;
  Vector stage_state_;
  std::optional<SwitchedStep> switched_;  // for dynamics with switches
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_TANGENT_STEP_H_
