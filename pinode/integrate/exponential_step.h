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

// A step for dynamics that are linear with constant matrices, except for laws
// at a few DOFs,
//
//   dy/dt = F y + G u + L r(y, z, t),   dz/dt = s(y, z, t),   y = [x; v].
//
// It uses the exponential Runge-Kutta method of S. Krogstad (J. Comput. Phys.
// 203 (2005) 72-88) of fourth order. Each stage, and the step, is the exact
// response to a polynomial for the laws' results r:
//
//   y_2 = y(dt/2) for r_1
//   y_3 = y(dt/2) for r_1 + (r_2 - r_1) 4 t/dt
//   y_4 = y(dt)   for r_1 + (r_3 - r_1) 2 t/dt
//   y+  = y(dt)   for the parabola through r_1, (r_2 + r_3) / 2 and r_4
//
// The inputs act as the parabola through their nodes. The step length therefore
// depends on laws and inputs, and not on the highest mode. The internal states
// z have no linear part; for them this is the classical method. At a stage,
// only the states that the laws use are computed. The derivatives are those of
// the discrete step. Use one object per thread.
class ExponentialStep {
 public:
  // Returns true if the dynamics contain only laws, and groups that follow
  // nothing.
  static bool Suits(const StructuralDynamics& dynamics);

  // Suits(dynamics) must be true.
  explicit ExponentialStep(const StructuralDynamics& dynamics);

  // Call it before steps with other parameters, with another step length, or
  // with derivatives after steps without them.
  void Prepare(const StructuralDynamics::Prepared& prepared, double step,
               bool with_parameters);

  // Advances *state (num_states) by one step.
  void Advance(const StructuralDynamics::Prepared& prepared,
               const IntegrationGrid& grid, Eigen::Index interval, int substep,
               Vector* state);

  // Computes `count` steps from *state at the beginning of an interval, and
  // stores the data for sensitivities. states() has the state before the first
  // step and after each step.
  void RunBlock(const StructuralDynamics::Prepared& prepared,
                const IntegrationGrid& grid, Eigen::Index interval,
                Eigen::Index count, bool with_parameters, const Vector& state);
  const Matrix& states() const { return states_; }

  // Computes step k of the block for the sensitivities S = d h / d (start,
  // theta) before it, num_states x columns. `with_parameters`, as in the block,
  // is true if the last num_tangent_columns columns are those of the
  // parameters. This requires Prepare with parameters.
  void StepSensitivity(Eigen::Index k, bool with_parameters,
                       Matrix* sensitivity);

 private:
  using RowMajorMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  // Response over half a step or a whole one, y = e^(TF) y + sum_k W_k d_k.
  // d_0, d_1, d_2 are the derivatives of [u; r] with respect to the fraction of
  // T.
  struct Response {
    Matrix all;            // 2n x (2n + 3 (inputs + outputs))
    RowMajorMatrix local;  // its rows that laws use
    // Derivatives of these matrices with respect to the groups' parameters,
    // stacked. A whole step has both tables. Half a step has only the local
    // one.
    Matrix all_table;
    Matrix local_table;
  };
  enum Stage { kSecond, kThird, kFourth, kEnd };

  Response MakeResponse(const ParameterizedMap& map, bool with_all) const;
  // Returns [F G L] and its derivatives with respect to the groups' parameters.
  ParameterizedMap LinearPart(const StructuralDynamics::Prepared& prepared,
                              bool with_parameters) const;

  // Fills arguments_ and results_, and slopes_ if requested.
  void EvaluateStages(const StructuralDynamics::Prepared& prepared,
                      const IntegrationGrid& grid, Eigen::Index interval,
                      int substep, bool with_slopes, const Vector& state);
  void EvaluateLaws(const StructuralDynamics::Prepared& prepared, double time,
                    const double* input, bool with_slopes, int stage);
  // Sets y and the inputs' parabola of an argument. `share` is the fraction of
  // the step.
  void BeginArgument(const Vector& state, const double* begin,
                     const double* middle, const double* end, double share,
                     Stage stage);
  // Returns d_k of the laws' results in an argument.
  Eigen::VectorBlock<Vector> ResultsOf(Stage stage, int k);
  // Returns the first column of W_k that belongs to the laws' results.
  Eigen::Index ResultColumn(int k) const;
  // Sets the states that laws use at the point of `stage` from its argument.
  // Advances z with the rates of the stage before.
  void MovePoint(const Response& response, Stage stage, const Vector& state,
                 double duration);
  void EndState(Vector* state) const;
  // Computes rates_[stage] = d [r; dz/dt] with respect to all columns, from d q
  // and d z of the stage.
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

  // Data of a step: arguments [y; d_0; d_1; d_2] of the responses, and [r;
  // dz/dt] at the four stages with its slopes (see LocalLaws) and its
  // sensitivities.
  std::array<Vector, 4> arguments_;
  std::array<Vector, 4> results_;
  std::array<Matrix, 4> slopes_;
  std::array<Matrix, 4> rates_;
  Vector point_;  // a stage; only the states that laws use are set
  // Data of a block: states; arguments (one column per step) and the groups'
  // changes of their responses; slopes, four per step.
  Matrix states_;
  std::array<Matrix, 4> block_arguments_;
  std::array<Matrix, 4> changes_;
  std::vector<Matrix> block_slopes_;
  Matrix next_;
  Matrix local_half_, local_whole_, local_, internal_;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_EXPONENTIAL_STEP_H_
