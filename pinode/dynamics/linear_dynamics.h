// Linear part of the equation of motion, with constant matrices.

#ifndef PINODE_DYNAMICS_LINEAR_DYNAMICS_H_
#define PINODE_DYNAMICS_LINEAR_DYNAMICS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/wide_jet.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Meaning of one entry of the input vector u(t), which is in the model's units.
struct InputSpec {
  enum class Kind {
    kGroundAcceleration,  // index: direction of the structural model
    kForce,               // index: DOF
    kCovariate,           // measured quantity that groups or terms follow
    kGroundDisplacement,  // index: direction; for absolute displacements
    kRecordSwitch,        // 1 in one record, 0 in all others
    // Prescribed motion of a DOF by an actuator, see PrescribedDof. index: DOF.
    kPrescribedDisplacement,
    kPrescribedVelocity,
    kPrescribedAcceleration,
  };
  Kind kind = Kind::kForce;
  int index = 0;
  std::string name;
};

// DOF p whose displacement, velocity and acceleration are inputs, as with an
// actuator. These inputs replace the entries of p in the state. The mass matrix
// must be uncoupled at p and have the entry m_p there. a_p is the acceleration
// that p would have if the actuator let it go. The actuator's force is then
//
//   f_p = m_p (acceleration - a_p),
//
// A load cell between actuator and structure measures this force. Other
// measured forces at p are not part of it.
struct PrescribedDof {
  // Index of the DOF.
  int dof = 0;
  // Indices of the inputs that hold its motion.
  int displacement = -1;
  int velocity = -1;
  int acceleration = -1;
};

// Parameter p that changes M, C or K by p * group->matrix. The term that owns
// the parameter also owns the group.
struct MatrixChange {
  const MatrixGroup* group = nullptr;
  // Index of p in theta. From Term::MatrixChanges(): index in the term's block.
  int parameter = 0;
  int column = -1;  // tangent column; -1: p is fixed
  // Derivative of p with respect to the parameter of that column. It differs
  // from 1 if p is tied.
  double factor = 1.0;
};

// Matrices of the linear part at one theta, each num_dofs x num_dofs unless
// stated.
struct LinearSystem {
  Matrix mass, damping, stiffness;  // including the changes
  Matrix mass_inverse;
  // Acceleration per unit input, num_dofs x inputs.
  Matrix input_map;
  // State matrix, d[v; a] / d[x; v] = [0, I; -M^-1 K, -M^-1 C].
  Matrix state_jacobian;
};

// Linear part of the dynamics,
//
//   dx/dt = v,   M dv/dt = B u(t) - C v - K x,
//
// M, C, K are the model's matrices plus the changes p_j M_j, p_j C_j, p_j K_j.
// B u is the vector of measured forces minus (M r + M_fs) a_g, with a_g the
// ground acceleration. The columns of r are the influence vectors, and M_fs
// couples the masses to the supports (see StructuralModel). StructuralDynamics
// adds its terms to this part. The terms define the parameters that change the
// matrices.
//
// The acceleration a_f that all forces cause, also those of terms, has the
// derivative
//
//   d a_f / d p_j = -M^-1 q_j,   q_j = K_j x,  C_j v  or  M_j (a_f + r a_g),
//
// with respect to parameter p_j, depending on the matrix that it changes.
class LinearDynamics {
 public:
  // Creates the linear part. `model` and `inputs` must be valid, see IsValid.
  LinearDynamics(StructuralModel model, std::vector<InputSpec> inputs);

  // Checks the model, and that every input acts on one of its DOFs or
  // directions. On failure returns false, and *error names the mismatch.
  [[nodiscard]] static bool IsValid(const StructuralModel& model,
                                    const std::vector<InputSpec>& inputs,
                                    std::string* error);

  const StructuralModel& model() const { return model_; }
  const std::vector<InputSpec>& inputs() const { return inputs_; }
  int num_dofs() const { return model_.num_dofs(); }
  int num_inputs() const { return static_cast<int>(inputs_.size()); }

  // Changes of the matrices by parameters.
  const std::vector<MatrixChange>& changes() const { return changes_; }
  void SetChanges(std::vector<MatrixChange> changes);

  // Returns the model with its matrices changed by the parameters in theta.
  StructuralModel ChangedModel(const Vector& theta) const;

  // Computes the linear part at theta. Returns false, with *error, if the
  // changed mass matrix is not positive definite.
  [[nodiscard]] bool Prepare(const Vector& theta, LinearSystem* system,
                             std::string* error) const;

  // Computes `rate` = d[x; v]/dt (2 num_dofs entries) without any term. `input`
  // has num_inputs() entries. `state` begins with [x; v].
  void Rate(const LinearSystem& system, const double* input,
            const double* state, double* rate) const;
  void Rate(const LinearSystem& system, const double* input,
            const WideJet* state, WideJet* rate) const;

  // Adds to the Jets of `acceleration` (num_dofs) their derivatives with
  // respect to theta through the matrices. The values of `theta` must be those
  // of `system`. `force_acceleration` (num_dofs) is the complete a_f.
  void AddVariation(const LinearSystem& system, const double* input,
                    const WideJet* state, const WideJet* theta,
                    const WideJet* force_acceleration,
                    WideJet* acceleration) const;

  // Number of changes whose parameter is free.
  int num_free_changes() const {
    return static_cast<int>(free_changes_.size());
  }
  // Computes the vectors q_j of the free changes at one point. `forces` is
  // num_dofs x num_free_changes().
  void ChangeForces(const double* input, const double* state,
                    const Vector& force_acceleration, Matrix* forces) const;

  // Working memory of AddParameterTangents().
  struct TangentScratch {
    Matrix velocity_map;  // rows x num_dofs
    Matrix product;       // rows x num_free_changes
  };
  // Allocates working memory for `rows` rows of `left`.
  TangentScratch MakeTangentScratch(int rows) const;
  // Adds left * [0; -M^-1 q_j; 0] to the tangent column of each free change.
  // `forces` holds the q_j. `left` is rows x num_states. `result` is rows x
  // tangent columns, stored by columns.
  void AddParameterTangents(const LinearSystem& system, const Matrix& forces,
                            const Matrix& left, TangentScratch* scratch,
                            double* result) const;

  // Adds derivatives of A in dh/dt = A [h; u], the linear part alone. A is 2
  // num_dofs x (2 num_dofs + num_inputs()). The derivative with respect to each
  // free change is added to the matrix of its tangent column. The cost is
  // proportional to the nonzero rows and columns of the changes.
  void AddRateDerivatives(const LinearSystem& system,
                          std::vector<Matrix>* derivatives) const;

 private:
  template <typename T>
  void RateOf(const LinearSystem& system, const double* input, const T* state,
              T* rate) const;
  // Returns r a_g of DOF `dof`.
  double GroundAcceleration(int dof, const double* input) const;

  StructuralModel model_;
  std::vector<InputSpec> inputs_;
  std::vector<MatrixChange> changes_;
  std::vector<MatrixChange> free_changes_;  // those with a column
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_LINEAR_DYNAMICS_H_
