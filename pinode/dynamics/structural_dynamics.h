// The right-hand side dh/dt of the structure, including all possible unknowns,
// and its derivatives.

#ifndef PINODE_DYNAMICS_STRUCTURAL_DYNAMICS_H_
#define PINODE_DYNAMICS_STRUCTURAL_DYNAMICS_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/parameter_block.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/force_scale_term.h"
#include "pinode/dynamics/group_curve.h"
#include "pinode/dynamics/group_term.h"
#include "pinode/dynamics/law_term.h"
#include "pinode/dynamics/linear_dynamics.h"
#include "pinode/dynamics/network_term.h"
#include "pinode/dynamics/term.h"
#include "pinode/dynamics/unknown_force.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// The equation of motion of Lai et al. (2021), eqs. (5), (13), (15), (18), in
// first-order form with state h = [x; v; z]:
//
//   M a + C v + K x = B u(t) - sum_j S_j g_j(q_j)      (forces)
//                            + sum_j s_j F_j(t)        (unknown forces)
//   dx/dt = v,  dv/dt = a + sum_j S_j g_j(q_j)         (accelerations)
//   dz/dt = r(q, z)                                    (hysteretic laws)
//
// with M, C, K the model's matrices plus group corrections, and B u = -(M r +
// M_fs) a_g for ground motion. Measured forces may have an unknown scale.
// LinearDynamics is the part that is linear with constant matrices. Everything
// else is a list of terms (term.h). This class combines them. For DOFs with
// prescribed motion, rates are those at the prescribed state, whatever the
// state contains. Integrators call Prescribe after each step.
//
// Build it once, add the terms, then only read: all const functions are safe to
// call from several threads, each with its own Linearization objects.
class StructuralDynamics {
 public:
  // Creates the dynamics from a valid model and valid inputs
  // (LinearDynamics::IsValid). Aborts otherwise.
  StructuralDynamics(StructuralModel model, std::vector<InputSpec> inputs);

  // Creates the dynamics from any model and inputs. Returns nullptr with a
  // sentence in *error if they are not valid.
  [[nodiscard]] static std::unique_ptr<StructuralDynamics> Create(
      StructuralModel model, std::vector<InputSpec> inputs, std::string* error);

  // Copies have copies of the terms.
  StructuralDynamics(const StructuralDynamics& other);
  StructuralDynamics& operator=(const StructuralDynamics& other);
  StructuralDynamics(StructuralDynamics&& other) = default;
  StructuralDynamics& operator=(StructuralDynamics&& other) = default;

  // Each function adds a term. It returns false with a sentence in *error, and
  // adds nothing, if sizes, features, DOFs or parameters do not fit.
  [[nodiscard]] bool AddGroup(GroupTerm term, std::string* error);
  [[nodiscard]] bool AddLaw(LawTerm term, std::string* error);
  [[nodiscard]] bool AddUnknownForce(UnknownForceTerm term, std::string* error);
  // Adds a curve to an existing group; see GroupCurve.
  [[nodiscard]] bool AddGroupCurve(GroupCurve curve, std::string* error);
  [[nodiscard]] bool AddForceScale(ForceScaleTerm term, std::string* error);
  [[nodiscard]] bool AddNetwork(NetworkTerm term, std::string* error);
  // Sets the scales of an existing network, see NetworkArchitecture: empty, or
  // one positive number per input and output. Returns false with a sentence in
  // *error, and changes nothing, if there is no such network or a scale is not
  // valid.
  [[nodiscard]] bool SetNetworkScales(int network, const Vector& input,
                                      const Vector& output, std::string* error);
  // Adds a named element between two DOFs, see MakeElement.
  [[nodiscard]] bool AddElement(const std::string& name,
                                const std::string& type, int from, int to,
                                const std::vector<double>& values,
                                std::string* error);
  // Adds a term of any kind.
  [[nodiscard]] bool AddTerm(std::unique_ptr<Term> term, std::string* error);

  const LinearDynamics& linear_dynamics() const { return linear_; }
  const StructuralModel& model() const { return linear_.model(); }
  const std::vector<InputSpec>& inputs() const { return linear_.inputs(); }
  // DOFs with prescribed motion.
  const std::vector<PrescribedDof>& prescribed() const { return prescribed_; }
  // Writes the prescribed motion at an instant into a state.
  template <typename T>
  void Prescribe(const double* input, T* state) const {
    for (const PrescribedDof& p : prescribed_) {
      state[p.dof] = T(input[p.displacement]);
      state[num_dofs() + p.dof] = T(input[p.velocity]);
    }
  }
  // Sets the prescribed rows in the sensitivities (num_states rows) of a state
  // to zero, after Prescribe: the prescribed motion depends on no parameter.
  void PrescribeSensitivity(Matrix* sensitivity) const;

  const std::vector<GroupTerm>& groups() const;
  TermRange<LawTerm> laws() const { return Range<LawTerm>(TermKind::kLaw); }
  TermRange<UnknownForceTerm> unknown_forces() const {
    return Range<UnknownForceTerm>(TermKind::kUnknownForce);
  }
  TermRange<GroupCurve> group_curves() const {
    return Range<GroupCurve>(TermKind::kGroupCurve);
  }
  TermRange<ForceScaleTerm> force_scales() const {
    return Range<ForceScaleTerm>(TermKind::kForceScale);
  }
  TermRange<NetworkTerm> networks() const {
    return Range<NetworkTerm>(TermKind::kNetwork);
  }
  // All terms, in the order of their blocks: block b is that of term b.
  int num_terms() const { return static_cast<int>(terms_.size()); }
  const Term& term(int term) const { return *terms_[Index(term)]; }

  // Returns true if dh/dt = F h + G u with constant F and G. This holds if
  // there are only groups that follow nothing and idle laws, and no prescribed
  // motion.
  bool IsLinear() const;

  // Returns a copy with the same parameters in which groups follow nothing.
  // Each group has its mean value over the samples of all inputs. To first
  // order, a stationary motion shows this mean of small slow changes of the
  // matrices. Groups that follow the time are unchanged if no time is given.
  StructuralDynamics Averaged(const Conditions& over) const;
  // Returns the names of the parameters by which groups follow covariates.
  std::vector<std::string> CovariateParameters() const;
  // Returns a copy in which `change` was applied to the parameters of groups
  // and of their curves. It may change values, or which parameters are free (in
  // a curve all of them or none).
  StructuralDynamics WithGroupParameters(
      const std::function<void(Parameter*)>& change) const;

  int num_dofs() const { return linear_.num_dofs(); }
  int num_internal() const { return num_internal_; }
  int num_states() const { return 2 * num_dofs() + num_internal_; }
  int num_inputs() const { return linear_.num_inputs(); }
  // Returns "x[u1]", "v[u1]", "z[name]".
  std::vector<std::string> StateNames() const;

  // Blocks of the flat parameter vector theta: one block for all groups (named
  // "groups"; absent without groups), one per law, one per unknown force, one
  // per curve of a group, one per force scale, one per term of another kind,
  // one per network.
  const std::vector<ParameterBlock>& blocks() const { return blocks_; }
  // Indices of the terms' blocks.
  int unknown_force_block(int force) const {
    return FirstOf(TermKind::kUnknownForce) + force;
  }
  int group_curve_block(int curve) const {
    return FirstOf(TermKind::kGroupCurve) + curve;
  }
  int force_scale_block(int scale) const {
    return FirstOf(TermKind::kForceScale) + scale;
  }
  int network_block(int network) const {
    return FirstOf(TermKind::kNetwork) + network;
  }
  int block_offset(int block) const { return offsets_[Index(block)].parameter; }
  int num_parameters() const { return num_parameters_; }
  Vector Parameters() const;
  void SetParameters(const Vector& theta);

  // Free parameters, in their order: tangent_columns()[j] is the index in theta
  // of tangent column j.
  const std::vector<int>& tangent_columns() const { return tangent_columns_; }
  int num_tangent_columns() const {
    return static_cast<int>(tangent_columns_.size());
  }

  // All quantities that depend on theta alone.
  struct Prepared {
    Vector theta;
    LinearSystem linear;
    std::vector<std::unique_ptr<TermPrepared>> terms;
  };
  // Computes these quantities. Returns false with a sentence if the corrected
  // mass matrix is not positive definite, or if the size of theta is not
  // num_parameters.
  [[nodiscard]] bool Prepare(const Vector& theta, Prepared* prepared,
                             std::string* error) const;
  // Derivative of dv/dt with respect to the outputs of a network, num_dofs x
  // outputs.
  const Matrix& NetworkMap(const Prepared& prepared, int network) const {
    return prepared.terms[Index(network_block(network))]->output_map;
  }

  // The dynamics linearised at one (t, h, u), as stored for a Runge-Kutta
  // stage.
  struct Linearization {
    Vector rate;      // dh/dt
    Matrix jacobian;  // d rate / d h
    // Factored derivative with respect to theta, see AddParameterTangents.
    Vector force_acceleration;  // a without accelerating terms
    Matrix change_forces;       // see LinearDynamics::ChangeForces
    Vector prescribed_state;    // empty without prescribed motion
    std::vector<std::unique_ptr<TermLinearization>> terms;
  };
  Linearization MakeLinearization() const;

  // Computes rate, num_states values.
  void Rate(const Prepared& prepared, double time, const double* input,
            const double* state, double* rate, Linearization* scratch) const;

  // Fills *linearization. Allocates no memory.
  void Linearize(const Prepared& prepared, double time, const double* input,
                 const double* state, Linearization* linearization) const;

  // Working memory of AddParameterTangents for a given number of rows.
  struct TangentScratch {
    int rows = 0;
    LinearDynamics::TangentScratch linear;
    std::vector<std::unique_ptr<TermTangentScratch>> terms;
  };
  TangentScratch MakeTangentScratch(int rows) const;

  // Computes *result += sum_s left_s * (d rate / d theta)_s over up to four
  // points, with left_s of rows x num_states and result of rows x
  // num_tangent_columns. Networks contribute one small matrix product per layer
  // for all points together. Allocates no memory.
  void AddParameterTangents(const Prepared& prepared,
                            const Linearization* const* points,
                            const Matrix* const* lefts, int num_points,
                            TangentScratch* scratch, double* result) const;

  // Computes the same right-hand side on Jets, for derivatives = "jets".
  // `theta` are wide Jets with the values of `prepared`.
  void Rate(const Prepared& prepared, double time, const double* input,
            const WideJet* state, const WideJet* theta, WideJet* rate) const;

  // Returns the model with M, C, K corrected by the groups that follow nothing.
  StructuralModel CorrectedModel(const Vector& theta) const;
  // Returns the same model with the DOFs of prescribed motion fixed, for modes.
  // It may have no DOF left.
  StructuralModel HeldModel(const Vector& theta) const;

 private:
  // First parameter, tangent column and internal state of a term.
  struct Offsets {
    int parameter = 0;
    int column = 0;
    TermPlace place;
  };

  static size_t Index(int i) { return static_cast<size_t>(i); }
  // Returns the first term of this kind, or of a later kind.
  int FirstOf(TermKind kind) const;
  template <typename Description>
  TermRange<Description> Range(TermKind kind) const;
  // Recomputes blocks, offsets and changes of the matrices.
  void Layout();
  template <typename T>
  TermPoint<T> PointOf(int term, double time, const double* input,
                       const T* state, const T* theta) const;
  template <typename T>
  TermRate<T> RateOf(int term, T* rate, T* force_acceleration) const;

  // Returns `state`, or *copy with the prescribed motion.
  const double* Prescribed(const double* input, const double* state,
                           Vector* copy) const;
  // Returns false if the term would change the mass of a DOF with prescribed
  // motion.
  bool LeavesPrescribedMasses(const Term& term, std::string* error) const;

  LinearDynamics linear_;
  std::vector<PrescribedDof> prescribed_;
  std::vector<std::unique_ptr<Term>> terms_;  // by kind, then as added
  std::vector<Offsets> offsets_;              // of each term
  std::vector<ParameterBlock> blocks_;        // of each term
  std::vector<int> tangent_columns_;
  int num_internal_ = 0;
  int num_parameters_ = 0;
};

template <typename Description>
TermRange<Description> StructuralDynamics::Range(TermKind kind) const {
  const int first = FirstOf(kind);
  int last = first;
  while (last < num_terms() && term(last).kind() == kind) ++last;
  return TermRange<Description>(terms_.data() + first, Index(last - first));
}

}  // namespace pinode

#endif  // PINODE_DYNAMICS_STRUCTURAL_DYNAMICS_H_
