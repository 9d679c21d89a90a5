// The right-hand side dh/dt of the structure, with everything that may be
// unknown in it, and its derivatives.

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
// with M, C, K the model's matrices plus group corrections, and
// B u = -(M r + M_fs) a_g for ground motion; measured forces may have an
// unknown scale. What is linear with constant matrices is LinearDynamics,
// everything else a list of terms (term.h); here they are put together. Where
// the motion of a DOF is prescribed, rates are those at the prescribed state,
// whatever the state says, and who integrates calls Prescribe after each step.
//
// Build it once, add the terms, then only read: all const functions are safe
// to call from several threads, each with its own Linearization objects.
class StructuralDynamics {
 public:
  // From a model and inputs that are known to be valid
  // (LinearDynamics::IsValid); others abort.
  StructuralDynamics(StructuralModel model, std::vector<InputSpec> inputs);

  // From any: nullptr with a sentence in *error where they are not valid.
  [[nodiscard]] static std::unique_ptr<StructuralDynamics> Create(
      StructuralModel model, std::vector<InputSpec> inputs, std::string* error);

  // Copies have terms of their own.
  StructuralDynamics(const StructuralDynamics& other);
  StructuralDynamics& operator=(const StructuralDynamics& other);
  StructuralDynamics(StructuralDynamics&& other) = default;
  StructuralDynamics& operator=(StructuralDynamics&& other) = default;

  // Each returns false with a sentence in *error where sizes, features, DOFs
  // or parameters do not fit; nothing is added then.
  [[nodiscard]] bool AddGroup(GroupTerm term, std::string* error);
  [[nodiscard]] bool AddLaw(LawTerm term, std::string* error);
  [[nodiscard]] bool AddUnknownForce(UnknownForceTerm term, std::string* error);
  // Of a group that was added; see GroupCurve.
  [[nodiscard]] bool AddGroupCurve(GroupCurve curve, std::string* error);
  [[nodiscard]] bool AddForceScale(ForceScaleTerm term, std::string* error);
  [[nodiscard]] bool AddNetwork(NetworkTerm term, std::string* error);
  // Scales of a network that was added, see NetworkArchitecture: empty, or one
  // positive number an input and an output. False with a sentence in *error
  // where there is no such network or a scale is none; nothing changes then.
  [[nodiscard]] bool SetNetworkScales(int network, const Vector& input,
                                      const Vector& output, std::string* error);
  // A named element between two DOFs, see MakeElement.
  [[nodiscard]] bool AddElement(const std::string& name,
                                const std::string& type, int from, int to,
                                const std::vector<double>& values,
                                std::string* error);
  // A term of any kind.
  [[nodiscard]] bool AddTerm(std::unique_ptr<Term> term, std::string* error);

  const LinearDynamics& linear_dynamics() const { return linear_; }
  const StructuralModel& model() const { return linear_.model(); }
  const std::vector<InputSpec>& inputs() const { return linear_.inputs(); }
  // The DOFs whose motion is prescribed.
  const std::vector<PrescribedDof>& prescribed() const { return prescribed_; }
  // The motion that is prescribed at an instant, written into a state.
  template <typename T>
  void Prescribe(const double* input, T* state) const {
    for (const PrescribedDof& p : prescribed_) {
      state[p.dof] = T(input[p.displacement]);
      state[num_dofs() + p.dof] = T(input[p.velocity]);
    }
  }
  // What is prescribed depends on nothing: zero rows in the sensitivities
  // (num_states rows) of a state after Prescribe.
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

  // Whether dh/dt = F h + G u with constant F and G: nothing but groups that
  // follow nothing and laws that are idle, and no prescribed motion.
  bool IsLinear() const;

  // A copy with the same parameters whose groups follow nothing: each is as
  // large as the mean of what it follows over the samples of all inputs makes
  // it. Of small slow changes of its matrices a stationary motion shows the
  // mean, to the first order. Groups that follow the time stay as they are
  // where none is given.
  StructuralDynamics Averaged(const Conditions& over) const;
  // Names of the parameters by which groups follow covariates.
  std::vector<std::string> CovariateParameters() const;
  // A copy, after a change of the parameters of groups and of their curves: of
  // values, or of which are free, in a curve all of them or none.
  StructuralDynamics WithGroupParameters(
      const std::function<void(Parameter*)>& change) const;

  int num_dofs() const { return linear_.num_dofs(); }
  int num_internal() const { return num_internal_; }
  int num_states() const { return 2 * num_dofs() + num_internal_; }
  int num_inputs() const { return linear_.num_inputs(); }
  // "x[u1]", "v[u1]", "z[name]".
  std::vector<std::string> StateNames() const;

  // The flat parameter vector theta: one block for all groups (named
  // "groups"; absent where there are none), one per law, one per unknown force,
  // one per curve of a group, one per force scale, one per term of another
  // kind, one per network.
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

  // The free parameters, in their order: tangent_columns()[j] is the index in
  // theta of tangent column j.
  const std::vector<int>& tangent_columns() const { return tangent_columns_; }
  int num_tangent_columns() const {
    return static_cast<int>(tangent_columns_.size());
  }

  // Everything that depends on theta alone.
  struct Prepared {
    Vector theta;
    LinearSystem linear;
    std::vector<std::unique_ptr<TermPrepared>> terms;
  };
  // False with a sentence where the corrected mass matrix is not positive
  // definite, and where theta has another size than num_parameters.
  [[nodiscard]] bool Prepare(const Vector& theta, Prepared* prepared,
                             std::string* error) const;
  // dv/dt by the outputs of a network, num_dofs x outputs.
  const Matrix& NetworkMap(const Prepared& prepared, int network) const {
    return prepared.terms[Index(network_block(network))]->output_map;
  }

  // The dynamics linearised at one (t, h, u): what a Runge-Kutta stage keeps.
  struct Linearization {
    Vector rate;      // dh/dt
    Matrix jacobian;  // d rate / d h
    // The rest is the factored derivative by theta, see AddParameterTangents.
    Vector force_acceleration;  // a without what acts as an acceleration
    Matrix change_forces;       // see LinearDynamics::ChangeForces
    Vector prescribed_state;    // empty where no motion is prescribed
    std::vector<std::unique_ptr<TermLinearization>> terms;
  };
  Linearization MakeLinearization() const;

  // rate: num_states values.
  void Rate(const Prepared& prepared, double time, const double* input,
            const double* state, double* rate, Linearization* scratch) const;

  // Fills *linearization; no memory is allocated.
  void Linearize(const Prepared& prepared, double time, const double* input,
                 const double* state, Linearization* linearization) const;

  // Working memory of AddParameterTangents for a given number of rows.
  struct TangentScratch {
    int rows = 0;
    LinearDynamics::TangentScratch linear;
    std::vector<std::unique_ptr<TermTangentScratch>> terms;
  };
  TangentScratch MakeTangentScratch(int rows) const;

  // *result += sum_s left_s * (d rate / d theta)_s over up to four points,
  // with left_s of rows x num_states and result of rows x
  // num_tangent_columns. Networks enter as one small matrix product per layer
  // for all points together; nothing is allocated.
  void AddParameterTangents(const Prepared& prepared,
                            const Linearization* const* points,
                            const Matrix* const* lefts, int num_points,
                            TangentScratch* scratch, double* result) const;

  // The same right-hand side on Jets, for derivatives = "jets": `theta` as
  // wide Jets whose values are those of `prepared`.
  void Rate(const Prepared& prepared, double time, const double* input,
            const WideJet* state, const WideJet* theta, WideJet* rate) const;

  // The model with M, C, K corrected by the groups that follow nothing.
  StructuralModel CorrectedModel(const Vector& theta) const;
  // The same with the DOFs of prescribed motion held, for modes; may have no
  // DOF left.
  StructuralModel HeldModel(const Vector& theta) const;

 private:
  // Where a term's parameters, tangents and internal states begin.
  struct Offsets {
    int parameter = 0;
    int column = 0;
    TermPlace place;
  };

  static size_t Index(int i) { return static_cast<size_t>(i); }
  // The first term of a kind or of those behind it.
  int FirstOf(TermKind kind) const;
  template <typename Description>
  TermRange<Description> Range(TermKind kind) const;
  // Finds blocks, offsets and changes of the matrices anew.
  void Layout();
  template <typename T>
  TermPoint<T> PointOf(int term, double time, const double* input,
                       const T* state, const T* theta) const;
  template <typename T>
  TermRate<T> RateOf(int term, T* rate, T* force_acceleration) const;

  // `state`, or *copy with the prescribed motion.
  const double* Prescribed(const double* input, const double* state,
                           Vector* copy) const;
  // False where the term would change the mass of such a DOF.
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
