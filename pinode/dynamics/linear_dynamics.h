// The linear part of the equation of motion, with constant matrices.

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
    // Prescribed motion of a DOF by an actuator, see PrescribedDof. index: DOF.
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
  // Acceleration per unit input, num_dofs x inputs.
  Matrix input_map;
  // State matrix, d[v; a] / d[x; v] = [0, I; -M^-1 K, -M^-1 C].
  Matrix state_jacobian;
};

// The linear part of the dynamics,
//
//   dx/dt = v,   M dv/dt = B u(t) - C v - K x,
//
// with M, C, K the model's matrices plus the changes p_j M_j, p_j C_j, p_j K_j.
// B u are the measured forces - (M r + M_fs) a_g. StructuralDynamics adds its
// terms to this part. The terms define which parameters change the matrices.
//
// The acceleration a_f that forces cause has, with respect to the parameter of
// a change, the derivative
//
//   d a_f / d p_j = -M^-1 q_j,   q_j = K_j x,  C_j v  or  M_j (a_f + r a_g),
//
// where a_f includes all forces, also those of the terms.
class LinearDynamics {
 public:
  // `model` and `inputs` must be valid, see IsValid.
  LinearDynamics(StructuralModel model, std::vector<InputSpec> inputs);

  // Checks the model, and that every input acts on a DOF or in a direction of
  // it. On failure *error names the mismatch.
  [[nodiscard]] static bool IsValid(const StructuralModel& model,
                                    const std::vector<InputSpec>& inputs,
                                    std::string* error);

  const StructuralModel& model() const { return model_; }
  const std::vector<InputSpec>& inputs() const { return inputs_; }
  int num_dofs() const { return model_.num_dofs(); }
  int num_inputs() const { return static_cast<int>(inputs_.size()); }

  const std::vector<MatrixChange>& changes() const { return changes_; }
  void SetChanges(std::vector<MatrixChange> changes);

  // Returns the model with its matrices changed.
  StructuralModel ChangedModel(const Vector& theta) const;

  // Computes the linear part at theta. Returns false if the changed mass matrix
  // is not positive definite.
  [[nodiscard]] bool Prepare(const Vector& theta, LinearSystem* system,
                             std::string* error) const;

  // Computes rate (2 num_dofs) = d[x; v]/dt without any term, at `system`'s
  // theta.
  void Rate(const LinearSystem& system, const double* input,
            const double* state, double* rate) const;
  void Rate(const LinearSystem& system, const double* input,
            const WideJet* state, WideJet* rate) const;

  // Adds, on Jets, the derivatives of the acceleration (num_dofs) with respect
  // to theta, whose values are those of `system`. `force_acceleration`: the
  // complete a_f.
  void AddVariation(const LinearSystem& system, const double* input,
                    const WideJet* state, const WideJet* theta,
                    const WideJet* force_acceleration,
                    WideJet* acceleration) const;

  // Computes the free changes' forces q_j at one point, num_dofs x
  // num_free_changes.
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

  // Handles the linear part alone, dh/dt = A [h; u], with A: 2 num_dofs x (2
  // num_dofs + inputs). Adds the derivative of A with respect to each free
  // change to the matrix of its tangent column. The cost is that of the nonzero
  // rows and columns of the change.
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
