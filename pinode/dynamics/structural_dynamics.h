// Right-hand side dh/dt of the structure's equation of motion, including all
// unknowns, and its derivatives.

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

// Equation of motion of Z. Lai et al., J. Sound Vib. 508 (2021) 116196, eqs.
// (5), (13), (15) and (18), in first-order form with the state h = [x; v; z]:
//
//   M a + C v + K x = B u(t) - sum_j S_j g_j(q_j)      (forces)
//                            + sum_j s_j F_j(t)        (unknown forces)
//   dx/dt = v,  dv/dt = a + sum_j S_j g_j(q_j)         (accelerations)
//   dz/dt = r(q, z)                                    (hysteretic laws)
//
// x and v are displacements and velocities relative to the ground, z the
// internal states of hysteretic laws. M, C, K are the model's matrices plus the
// corrections by groups. For ground motion B u = -(M r + M_fs) a_g, see
// LinearDynamics. Measured forces may have an unknown scale. All quantities are
// in the model's units.
//
// LinearDynamics is the linear part with constant matrices. Everything else is
// a list of terms (term.h). This class combines both.
//
// If the motion of a DOF is prescribed, rates are computed at the prescribed
// state, whatever the state contains. Integrators call Prescribe() after each
// step.
//
// Create the object, add the terms, then only read it. All const functions may
// be called from several threads, each with its own Linearization objects.
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

  // Add a term. If sizes, features, DOFs or parameters do not fit, they add
  // nothing and return false, with a sentence in *error.
  [[nodiscard]] bool AddGroup(GroupTerm term, std::string* error);
  [[nodiscard]] bool AddLaw(LawTerm term, std::string* error);
  [[nodiscard]] bool AddUnknownForce(UnknownForceTerm term, std::string* error);
  // Adds a curve to an existing group, see GroupCurve.
  [[nodiscard]] bool AddGroupCurve(GroupCurve curve, std::string* error);
  [[nodiscard]] bool AddForceScale(ForceScaleTerm term, std::string* error);
  [[nodiscard]] bool AddNetwork(NetworkTerm term, std::string* error);
  // Sets the scales of an existing network, see NetworkArchitecture. `network`
  // counts from 0. `input` and `output` have one positive number per input or
  // output, or are empty. Changes nothing and returns false, with *error, if
  // there is no such network or a scale is not valid.
  [[nodiscard]] bool SetNetworkScales(int network, const Vector& input,
                                      const Vector& output, std::string* error);
  // Adds an element of a type such as "cubic" between two DOFs, see
  // MakeElement. `from` and `to` are indices of DOFs or Feature::kGround.
  // `values` are its parameters in the model's units. Fails as the functions
  // above.
  [[nodiscard]] bool AddElement(const std::string& name,
                                const std::string& type, int from, int to,
                                const std::vector<double>& values,
                                std::string* error);
  // Adds a term of any kind. Fails as the functions above.
  [[nodiscard]] bool AddTerm(std::unique_ptr<Term> term, std::string* error);

  const LinearDynamics& linear_dynamics() const { return linear_; }
  const StructuralModel& model() const { return linear_.model(); }
  const std::vector<InputSpec>& inputs() const { return linear_.inputs(); }
  // DOFs with prescribed motion.
  const std::vector<PrescribedDof>& prescribed() const { return prescribed_; }
  // Writes the prescribed motion at an instant into `state` (num_states()
  // entries). `input` has num_inputs() entries.
  template <typename T>
  void Prescribe(const double* input, T* state) const {
    for (const PrescribedDof& p : prescribed_) {
      state[p.dof] = T(input[p.displacement]);
      state[num_dofs() + p.dof] = T(input[p.velocity]);
    }
  }
  // Sets the rows of prescribed DOFs to zero in the sensitivities of a state
  // (num_states() rows). Call it after Prescribe(): prescribed motion depends
  // on no parameter.
  void PrescribeSensitivity(Matrix* sensitivity) const;

  // Terms of each kind, in the order in which they were added.
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
  // All terms, in the order of their parameter blocks: term(b) has blocks()[b].
  int num_terms() const { return static_cast<int>(terms_.size()); }
  const Term& term(int term) const { return *terms_[Index(term)]; }

  // True if dh/dt = F h + G u with constant F and G. This holds if no motion is
  // prescribed, and all terms are idle laws or groups that follow nothing.
  bool IsLinear() const;

  // Returns a copy with the same parameters in which groups follow nothing. The
  // value that a group follows is replaced by its mean over the samples in
  // `over`. If the matrices change little and slowly, stationary motion depends
  // on this mean, to first order. Groups that follow the time are unchanged if
  // `over` has no time.
  StructuralDynamics Averaged(const Conditions& over) const;
  // Returns the names of the parameters by which groups follow covariates.
  std::vector<std::string> CovariateParameters() const;
  // Returns a copy in which `change` was applied to each parameter of the
  // groups and of their curves. `change` may set values and may free or fix
  // parameters. Free all parameters of a curve or none.
  StructuralDynamics WithGroupParameters(
      const std::function<void(Parameter*)>& change) const;

  // Numbers of DOFs, of internal states z, of entries of h, and of inputs.
  int num_dofs() const { return linear_.num_dofs(); }
  int num_internal() const { return num_internal_; }
  int num_states() const { return 2 * num_dofs() + num_internal_; }
  int num_inputs() const { return linear_.num_inputs(); }
  // Returns the names of the entries of h: "x[u1]", "v[u1]", "z[name]".
  std::vector<std::string> StateNames() const;

  // Blocks of the vector theta of all parameters, one per term. They come in
  // this order: "groups" (all groups; absent without groups), laws, unknown
  // forces, curves of groups, force scales, terms of other kinds, networks.
  const std::vector<ParameterBlock>& blocks() const { return blocks_; }
  // Indices in blocks() of the blocks of such terms. The arguments count terms
  // of one kind from 0.
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
  // Index in theta of the first parameter of a block.
  int block_offset(int block) const { return offsets_[Index(block)].parameter; }
  int num_parameters() const { return num_parameters_; }
  // Current values of theta, num_parameters() entries in the parameters' units,
  // and their replacement.
  Vector Parameters() const;
  void SetParameters(const Vector& theta);

  // Tied parameters, by indices in theta. Prepare() and SetParameters() set
  // their values from those of their sources, whatever theta has there.
  const std::vector<ParameterTie>& ties() const { return ties_; }

  // Indices in theta of the free parameters. Derivatives with respect to
  // parameters have one column, a tangent column, for each of them.
  const std::vector<int>& tangent_columns() const { return tangent_columns_; }
  int num_tangent_columns() const {
    return static_cast<int>(tangent_columns_.size());
  }

  // Quantities that depend on theta alone.
  struct Prepared {
    Vector theta;
    LinearSystem linear;
    std::vector<std::unique_ptr<TermPrepared>> terms;
  };
  // Computes the quantities that depend on theta alone. Returns false, with
  // *error, if theta has not num_parameters() entries or the corrected mass
  // matrix is not positive definite.
  [[nodiscard]] bool Prepare(const Vector& theta, Prepared* prepared,
                             std::string* error) const;
  // Derivative of dv/dt with respect to the outputs of a network, num_dofs() x
  // outputs. `network` counts from 0.
  const Matrix& NetworkMap(const Prepared& prepared, int network) const {
    return prepared.terms[Index(network_block(network))]->output_map;
  }

  // Dynamics linearised at one time, state and input. Integrators store one for
  // each Runge-Kutta stage.
  struct Linearization {
    Vector rate;      // dh/dt
    Matrix jacobian;  // d rate / d h, num_states() x num_states()
    // Factors of the derivative with respect to theta, see
    // AddParameterTangents.
    Vector force_acceleration;  // a: acceleration due to forces
    Matrix change_forces;       // see LinearDynamics::ChangeForces
    Vector prescribed_state;    // empty if no DOF is prescribed
    std::vector<std::unique_ptr<TermLinearization>> terms;
  };
  // Allocates a linearization.
  Linearization MakeLinearization() const;

  // Computes `rate` = dh/dt (num_states() entries). `time` is in the model's
  // unit. `input` has num_inputs() entries, `state` num_states(). *scratch is
  // working memory.
  void Rate(const Prepared& prepared, double time, const double* input,
            const double* state, double* rate, Linearization* scratch) const;

  // Fills *linearization, which MakeLinearization() made. Allocates no memory.
  // The other arguments are those of Rate().
  void Linearize(const Prepared& prepared, double time, const double* input,
                 const double* state, Linearization* linearization) const;

  // Working memory of AddParameterTangents() for a given number of rows.
  struct TangentScratch {
    int rows = 0;
    LinearDynamics::TangentScratch linear;
    std::vector<std::unique_ptr<TermTangentScratch>> terms;
    // Columns of the terms if parameters are tied, rows x all their columns.
    Matrix by_terms;
  };
  // Allocates working memory for `rows` rows.
  TangentScratch MakeTangentScratch(int rows) const;

  // Adds sum_s left_s (d rate / d theta)_s to *result, summed over num_points
  // <= 4 points. `points` and `lefts` have num_points entries. Each left_s is
  // rows x num_states(). `result` is rows x num_tangent_columns(), stored by
  // columns. Allocates no memory.
  void AddParameterTangents(const Prepared& prepared,
                            const Linearization* const* points,
                            const Matrix* const* lefts, int num_points,
                            TangentScratch* scratch, double* result) const;

  // Switching functions at which dh/dt jumps, those of all terms. Integrators
  // that find them cut their steps there (SwitchedStep).
  int num_switches() const { return num_switches_; }
  // Computes their values, num_switches() entries. Arguments as of Rate().
  void Switches(const Prepared& prepared, double time, const double* input,
                const double* state, double* values) const;
  // Computes the gradient of switch j by the state, num_states() entries.
  void SwitchGradient(int j, const Prepared& prepared, double time,
                      const double* input, const double* state,
                      double* gradient) const;
  // Keeps Rate() and Linearize() with this memory on a branch of each switch:
  // that of positive values where the entry is not 0. `branches` has
  // num_switches() entries and must outlive the calls. nullptr: the branches at
  // the state.
  void SetBranches(const char* branches, Linearization* linearization) const;

  // Computes the same `rate` on Jets, for `derivatives = "jets"`. `theta` has
  // num_parameters() Jets, whose values must be those of `prepared`.
  void Rate(const Prepared& prepared, double time, const double* input,
            const WideJet* state, const WideJet* theta, WideJet* rate) const;

  // Returns the model with M, C, K corrected by the groups that follow nothing.
  // `theta` has num_parameters() entries.
  StructuralModel CorrectedModel(const Vector& theta) const;
  // Returns the corrected model without the DOFs of prescribed motion, which
  // are fixed. Use it for modes. The model may have no DOF left.
  StructuralModel HeldModel(const Vector& theta) const;

 private:
  // First parameter, tangent column and internal state of a term. Its columns
  // count those of tied parameters too if there are any.
  struct Offsets {
    int parameter = 0;
    int column = 0;
    TermPlace place;
  };
  // Tangent column to which a term's column is added times `factor`; -1: none,
  // because the source of a tie is fixed.
  struct TermColumn {
    int column = -1;
    double factor = 1.0;
  };

  static size_t Index(int i) { return static_cast<size_t>(i); }
  // Returns the first term of this kind, or of a later kind.
  int FirstOf(TermKind kind) const;
  template <typename Description>
  TermRange<Description> Range(TermKind kind) const;
  // Recomputes blocks, offsets and changes of the matrices.
  void Layout();
  // Finds the ties and sets the values of tied parameters.
  void SetTies();
  // Fills term_columns_.
  void SetTermColumns();
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
  std::vector<ParameterTie> ties_;
  std::vector<TermColumn> term_columns_;
  int num_internal_ = 0;
  int num_parameters_ = 0;
  int num_switches_ = 0;
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
