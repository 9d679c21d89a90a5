// The part of the equation of motion that is linear with constant matrices.

#ifndef PINODE_DYNAMICS_LINEAR_DYNAMICS_H_
#define PINODE_DYNAMICS_LINEAR_DYNAMICS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/wide_jet.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// One entry of the input vector u(t).
struct InputSpec {
  enum class Kind {
    kGroundAcceleration,  // index: direction of the structural model
    kForce,               // index: DOF
    kCovariate,           // a measured quantity that groups or terms follow
    kGroundDisplacement,  // index: direction; for absolute displacements
    kRecordSwitch,        // one in one record, zero in all others
    // Motion of a DOF that an actuator prescribes, see PrescribedDof; index:
    // it.
    kPrescribedDisplacement,
    kPrescribedVelocity,
    kPrescribedAcceleration,
  };
  Kind kind = Kind::kForce;
  int index = 0;
  std::string name;
};

// A DOF p of which displacement, velocity and acceleration are inputs. The
// state's entries of p are these inputs; its equation of motion says which
// force moves it. With the mass matrix uncoupled at p, m_p its entry there and
// a_p the acceleration that the structure would give to p if it were let go,
//
//   f_p = m_p (acceleration - a_p),
//
// the force that acts on p beside the measured ones: what a load cell between
// actuator and structure reads.
struct PrescribedDof {
  int dof = 0;
  // Indices into the inputs.
  int displacement = -1;
  int velocity = -1;
  int acceleration = -1;
};

// A parameter p that changes a matrix: M, C or K += p * group->matrix. The
// group lives in the term whose parameter it is.
struct MatrixChange {
  const MatrixGroup* group = nullptr;
  int parameter = 0;  // index in theta; where a term gives it, in its own block
  int column = -1;    // tangent column, -1 where p is fixed
};

// The linear part at one theta.
struct LinearSystem {
  Matrix mass, damping, stiffness;  // with their changes
  Matrix mass_inverse;
  // num_dofs x inputs: acceleration per unit input.
  Matrix input_map;
  // d[v; a] / d[x; v] = [0, I; -M^-1 K, -M^-1 C].
  Matrix state_jacobian;
};

//   dx/dt = v,   M dv/dt = B u(t) - C v - K x,
//
// with M, C, K the model's matrices plus the changes p_j M_j, p_j C_j, p_j K_j,
// and B u the measured forces - (M r + M_fs) a_g. The terms of
// StructuralDynamics come on top of it; which parameters change its matrices,
// they tell it.
//
// By the parameter of a change the acceleration a_f that forces cause has the
// derivative
//
//   d a_f / d p_j = -M^-1 q_j,   q_j = K_j x,  C_j v  or  M_j (a_f + r a_g),
//
// where a_f is that of all forces, those of the terms included.
class LinearDynamics {
 public:
  // `model` and `inputs` must be valid, see IsValid.
  LinearDynamics(StructuralModel model, std::vector<InputSpec> inputs);

  // Checks the model, and that every input acts on a DOF or in a direction of
  // it. On failure *error names what does not fit.
  [[nodiscard]] static bool IsValid(const StructuralModel& model,
                                    const std::vector<InputSpec>& inputs,
                                    std::string* error);

  const StructuralModel& model() const { return model_; }
  const std::vector<InputSpec>& inputs() const { return inputs_; }
  int num_dofs() const { return model_.num_dofs(); }
  int num_inputs() const { return static_cast<int>(inputs_.size()); }

  const std::vector<MatrixChange>& changes() const { return changes_; }
  void SetChanges(std::vector<MatrixChange> changes);

  // The model with its matrices changed.
  StructuralModel ChangedModel(const Vector& theta) const;

  // False where the changed mass matrix is not positive definite.
  [[nodiscard]] bool Prepare(const Vector& theta, LinearSystem* system,
                             std::string* error) const;

  // rate (2 num_dofs) = d[x; v]/dt without any term, at `system`'s theta.
  void Rate(const LinearSystem& system, const double* input,
            const double* state, double* rate) const;
  void Rate(const LinearSystem& system, const double* input,
            const WideJet* state, WideJet* rate) const;

  // On Jets: what the acceleration (num_dofs) gets from derivatives of theta,
  // whose values are those of `system`. `force_acceleration`: a_f complete.
  void AddVariation(const LinearSystem& system, const double* input,
                    const WideJet* state, const WideJet* theta,
                    const WideJet* force_acceleration,
                    WideJet* acceleration) const;

  // The free changes' forces q_j at one point, num_dofs x num_free_changes.
  int num_free_changes() const {
    return static_cast<int>(free_changes_.size());
  }
  void ChangeForces(const double* input, const double* state,
                    const Vector& force_acceleration, Matrix* forces) const;

  // Adds left * [0; -M^-1 q_j; 0] to the tangent column of each free change.
  // left: rows x num_states; result: rows x tangent columns.
  struct TangentScratch {
    Matrix velocity_map;  // rows x num_dofs
    Matrix product;       // rows x num_free_changes
  };
  TangentScratch MakeTangentScratch(int rows) const;
  void AddParameterTangents(const LinearSystem& system, const Matrix& forces,
                            const Matrix& left, TangentScratch* scratch,
                            double* result) const;

  // Of the linear part alone, dh/dt = A [h; u], A: 2 num_dofs x (2 num_dofs +
  // inputs). Adds the derivative of A by each free change to the matrix of its
  // tangent column, at the price of the rows and columns that the change has.
  void AddRateDerivatives(const LinearSystem& system,
                          std::vector<Matrix>* derivatives) const;

 private:
  template <typename T>
  void RateOf(const LinearSystem& system, const double* input, const T* state,
              T* rate) const;
  // r a_g of DOF `dof`.
  double GroundAcceleration(int dof, const double* input) const;

  StructuralModel model_;
  std::vector<InputSpec> inputs_;
  std::vector<MatrixChange> changes_;
  std::vector<MatrixChange> free_changes_;  // those with a column
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_LINEAR_DYNAMICS_H_
