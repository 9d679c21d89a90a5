// Steps that are exact for a structure's linear part.

#ifndef PINODE_INTEGRATE_EXPONENTIAL_STEP_H_
#define PINODE_INTEGRATE_EXPONENTIAL_STEP_H_

#include <array>
#include <optional>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/linear_rate.h"
#include "pinode/integrate/local_laws.h"

namespace pinode {

// For dynamics that are linear with constant matrices but for laws at a few
// DOFs,
//
//   dy/dt = F y + G u + L r(y, z, t),   dz/dt = s(y, z, t),   y = [x; v],
//
// the exponential Runge-Kutta method of S. Krogstad (J. Comput. Phys. 203
// (2005) 72-88) of fourth order. Each stage, and the step, is the exact
// response to a polynomial for the laws' results r:
//
//   y_2 = y(dt/2) for r_1
//   y_3 = y(dt/2) for r_1 + (r_2 - r_1) 4 t/dt
//   y_4 = y(dt)   for r_1 + (r_3 - r_1) 2 t/dt
//   y+  = y(dt)   for the parabola through r_1, (r_2 + r_3) / 2 and r_4
//
// and the inputs act as the parabola through their nodes, so that the step
// follows laws and inputs, and not the highest mode. The internal states z have
// no linear part; for them this is the classical method. Of a stage only what
// the laws look at is worked out. The derivatives are those of the discrete
// step. One object per thread.
class ExponentialStep {
 public:
  // Whether there is nothing but groups that follow nothing, and laws.
  static bool Suits(const StructuralDynamics& dynamics);

  // `dynamics` must suit.
  explicit ExponentialStep(const StructuralDynamics& dynamics);

  // Before steps with other parameters, another length of step, or derivatives
  // where there were none.
  void Prepare(const StructuralDynamics::Prepared& prepared, double step,
               bool with_parameters);

  // Advances *state (num_states) by one step.
  void Advance(const StructuralDynamics::Prepared& prepared,
               const IntegrationGrid& grid, Eigen::Index interval, int substep,
               Vector* state);

  // `count` steps from *state at the beginning of an interval; keeps what
  // sensitivities need of them. states() has the state before the first and
  // after each of them.
  void RunBlock(const StructuralDynamics::Prepared& prepared,
                const IntegrationGrid& grid, Eigen::Index interval,
                Eigen::Index count, bool with_parameters, const Vector& state);
  const Matrix& states() const { return states_; }

  // Step k of the block for the sensitivities S = d h / d (start, theta) before
  // it, num_states x columns; `with_parameters`, as in the block: whether the
  // last num_tangent_columns of them are those of the parameters, which needs
  // to have been prepared.
  void StepSensitivity(Eigen::Index k, bool with_parameters,
                       Matrix* sensitivity);

 private:
  using RowMajorMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  // The response over half a step or a whole one, y = e^(TF) y + sum_k W_k d_k
  // with the derivatives d_0, d_1, d_2 of [u; r] by the share of T.
  struct Response {
    Matrix all;            // 2n x (2n + 3 (inputs + outputs))
    RowMajorMatrix local;  // the rows of it that laws look at
    // Their derivatives by the groups' parameters, one below the other; of a
    // whole step both, of half of one those of local rows.
    Matrix all_table;
    Matrix local_table;
  };
  enum Stage { kSecond, kThird, kFourth, kEnd };

  Response MakeResponse(const ParameterizedMap& map, bool with_all) const;
  // [F G L] and its derivatives by the groups' parameters.
  ParameterizedMap LinearPart(const StructuralDynamics::Prepared& prepared,
                              bool with_parameters) const;

  // Fills arguments_ and results_, and slopes_ where they are asked for.
  void EvaluateStages(const StructuralDynamics::Prepared& prepared,
                      const IntegrationGrid& grid, Eigen::Index interval,
                      int substep, bool with_slopes, const Vector& state);
  void EvaluateLaws(const StructuralDynamics::Prepared& prepared, double time,
                    const double* input, bool with_slopes, int stage);
  // y and the inputs' parabola of an argument; `share` of the step.
  void BeginArgument(const Vector& state, const double* begin,
                     const double* middle, const double* end, double share,
                     Stage stage);
  // d_k of the laws' results in an argument.
  Eigen::VectorBlock<Vector> ResultsOf(Stage stage, int k);
  // W_k's columns of the laws' results.
  Eigen::Index ResultColumn(int k) const;
  // What laws look at in the point of `stage`, from its argument, and z moved
  // along the rates of the stage before.
  void MovePoint(const Response& response, Stage stage, const Vector& state,
                 double duration);
  void EndState(Vector* state) const;
  // rates_[stage] = d [r; dz/dt] by all columns, at d q and d z of the stage.
  void LinearizeResults(int stage, const Matrix& slopes, int law_columns,
                        const Matrix& q, const Matrix& z);

  const StructuralDynamics& dynamics_;
  LocalLaws laws_;
  std::vector<int> forced_;    // DOFs on which laws act with a force
  StructuralDynamics linear_;  // with one more input at each of these

  double step_ = 0.0;
  bool has_parameters_ = false;
  Vector theta_;
  Response half_, whole_;

  // Of a step: arguments [y; d_0; d_1; d_2] of the responses, and [r; dz/dt] at
  // the four stages with its slopes (see LocalLaws) and its sensitivities.
  std::array<Vector, 4> arguments_;
  std::array<Vector, 4> results_;
  std::array<Matrix, 4> slopes_;
  std::array<Matrix, 4> rates_;
  Vector point_;  // a stage, of which only what laws look at is set
  // Of a block: states; arguments (a column a step), and what the groups change
  // of their responses; slopes, four a step.
  Matrix states_;
  std::array<Matrix, 4> block_arguments_;
  std::array<Matrix, 4> changes_;
  std::vector<Matrix> block_slopes_;
  Matrix next_;
  Matrix local_half_, local_whole_, local_, internal_;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_EXPONENTIAL_STEP_H_
