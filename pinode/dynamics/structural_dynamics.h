// The right-hand side dh/dt of the structure, with everything that may be
// unknown in it, and its derivatives.

#ifndef PINODE_DYNAMICS_STRUCTURAL_DYNAMICS_H_
#define PINODE_DYNAMICS_STRUCTURAL_DYNAMICS_H_

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/parameter_block.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/law.h"
#include "pinode/dynamics/unknown_force.h"
#include "pinode/network/network.h"
#include "pinode/structure/structural_model.h"

namespace pinode {

// One entry of the input vector u(t).
struct InputSpec {
  enum class Kind {
    kGroundAcceleration,  // index: direction of the structural model
    kForce,               // index: DOF
    kCovariate,           // a measured quantity that groups or terms follow
    kGroundDisplacement,  // index: direction; for absolute displacements
    kRecordSwitch,        // one in one record, zero in all others
  };
  Kind kind = Kind::kForce;
  int index = 0;
  std::string name;
};

// A correction alpha * matrix to K, C or M, optionally times
// (u[covariate] - reference) or (t - reference).
struct GroupTerm {
  enum class Follows { kNothing, kTime, kCovariate };
  MatrixGroup group;
  Parameter alpha;
  // How many times the group's matrix the model's matrices hold already: alpha
  // is a change of `present`, 0.1 more than 1 unless these were updated before.
  double present = 1.0;
  Follows follows = Follows::kNothing;
  int input = -1;          // kCovariate
  double reference = 0.0;  // seconds, or the covariate's unit
};

// What a term's result is: as an acceleration, outputs * result is added to
// dv/dt; as a force it resists, that is, outputs * result is subtracted from
// the right-hand side of the equation of motion.
enum class ActsAs { kAcceleration, kForce };

// A law. `outputs` (num_dofs x law outputs) puts its results on the DOFs.
struct LawTerm {
  std::string name;
  std::string type;  // an element type, "library" (see LibraryLaw), or "user"
  std::shared_ptr<const Law> law;
  std::vector<Feature> features;
  Matrix outputs;
  ActsAs acts_as = ActsAs::kForce;
  ParameterBlock parameters;
};

// A force that nobody measured: outputs * F(t) is added to the right-hand side.
struct UnknownForceTerm {
  std::string name;
  std::shared_ptr<const ForceHistory> history;
  Vector outputs;  // num_dofs
  // What happens in one record does not happen in another: an input that is
  // one in the force's record and zero in all others, by which the force is
  // multiplied. -1: the force acts in every record.
  int input = -1;
  ParameterBlock parameters;
  CombinationPrior prior;  // empty: none but the parameters' own
};

// A network.
struct NetworkTerm {
  using ActsAs = pinode::ActsAs;
  std::string name;
  std::shared_ptr<const Network> network;
  std::vector<Feature> features;
  Matrix outputs;  // num_dofs x network outputs
  std::vector<std::string> output_names;
  ActsAs acts_as = ActsAs::kAcceleration;
  ParameterBlock weights;
  // Weight decay: negative asks for the evidence's choice, otherwise the
  // precision of a zero-mean Gaussian prior.
  double decay = -1.0;
  // The weights were drawn at random and may be drawn again on the way to a
  // simpler network; false where they were learned before.
  bool drawn = true;
};

// The equation of motion of Lai et al. (2021), eqs. (5), (13), (15), (18), in
// first-order form with state h = [x; v; z]:
//
//   M a + C v + K x = B u(t) - sum_j S_j g_j(q_j)      (forces)
//                            + sum_j s_j F_j(t)        (unknown forces)
//   dx/dt = v,  dv/dt = a + sum_j S_j g_j(q_j)         (accelerations)
//   dz/dt = r(q, z)                                    (hysteretic laws)
//
// with M, C, K the model's matrices plus group corrections, and
// B u = -(M r + M_fs) a_g for ground motion.
//
// Build it once, add the terms, then only read: all const functions are safe
// to call from several threads, each with its own Stage objects.
class StructuralDynamics {
 public:
  // `model` must be valid (StructuralModel::IsValid).
  StructuralDynamics(StructuralModel model, std::vector<InputSpec> inputs);

  // Each returns false with a sentence in *error where sizes, features, DOFs
  // or parameters do not fit; nothing is added then.
  [[nodiscard]] bool AddGroup(GroupTerm term, std::string* error);
  [[nodiscard]] bool AddLaw(LawTerm term, std::string* error);
  [[nodiscard]] bool AddUnknownForce(UnknownForceTerm term, std::string* error);
  [[nodiscard]] bool AddNetwork(NetworkTerm term, std::string* error);

  const StructuralModel& model() const { return model_; }
  const std::vector<InputSpec>& inputs() const { return inputs_; }
  const std::vector<GroupTerm>& groups() const { return groups_; }
  const std::vector<LawTerm>& laws() const { return laws_; }
  const std::vector<UnknownForceTerm>& unknown_forces() const {
    return unknown_forces_;
  }
  const std::vector<NetworkTerm>& networks() const { return networks_; }

  int num_dofs() const { return model_.num_dofs(); }
  int num_internal() const { return num_internal_; }
  int num_states() const { return 2 * num_dofs() + num_internal_; }
  int num_inputs() const { return static_cast<int>(inputs_.size()); }
  // "x[u1]", "v[u1]", "z[name]".
  std::vector<std::string> StateNames() const;

  // The flat parameter vector theta: one block for all groups (named
  // "groups"; absent where there are none), one per law, one per unknown force,
  // one per network.
  const std::vector<ParameterBlock>& blocks() const { return blocks_; }
  // Indices of the terms' blocks.
  int unknown_force_block(int force) const {
    return network_block(0) - static_cast<int>(unknown_forces_.size()) + force;
  }
  int network_block(int network) const {
    return static_cast<int>(blocks_.size() - networks_.size()) + network;
  }
  int block_offset(int block) const {
    return block_offsets_[static_cast<size_t>(block)];
  }
  int num_parameters() const { return num_parameters_; }
  Vector Parameters() const;
  void SetParameters(const Vector& theta);

  // Tangents are computed for whole blocks; a block in which nothing is free
  // has no columns. tangent_columns()[j] is the index in theta of column j.
  const std::vector<int>& tangent_columns() const { return tangent_columns_; }
  int num_tangent_columns() const {
    return static_cast<int>(tangent_columns_.size());
  }

  // Everything that depends on theta alone.
  struct Prepared {
    Vector theta;
    Matrix mass, damping, stiffness;  // with the constant groups
    Matrix mass_inverse;
    Matrix input_map;       // num_dofs x inputs: acceleration per unit input
    Matrix input_force;     // num_dofs x inputs: force per unit input
    Matrix state_jacobian;  // of the linear part, num_states x num_states
    std::vector<Matrix> law_map;            // signed, per law
    std::vector<Vector> unknown_force_map;  // M^-1 s, per unknown force
    std::vector<Matrix> network_map;        // signed, per network
  };
  // False where the corrected mass matrix is not positive definite.
  [[nodiscard]] bool Prepare(const Vector& theta, Prepared* prepared,
                             std::string* error) const;

  // The dynamics linearised at one (t, h, u): what a Runge-Kutta stage keeps.
  struct Stage {
    Vector rate;      // dh/dt
    Matrix jacobian;  // d rate / d h
    // The rest is the factored derivative by theta, see AddParameterTangents.
    Vector force_acceleration;  // a without what acts as an acceleration
    Matrix group_forces;        // num_dofs x groups, times the followed value
    std::vector<Matrix> law_jacobians;  // results x arguments, row-major data
    std::vector<ForceHistory::Local> unknown_forces;  // times their input
    std::vector<NetworkTangent> network_tangents;
    // Scratch.
    std::vector<NetworkWorkspace> network_workspaces;
    Vector features, outputs, mapped;
  };
  Stage MakeStage() const;

  // rate: num_states values.
  void Rate(const Prepared& prepared, double time, const double* input,
            const double* state, double* rate, Stage* scratch) const;

  // Fills *stage; no memory is allocated.
  void Linearize(const Prepared& prepared, double time, const double* input,
                 const double* state, Stage* stage) const;

  // Working memory of AddParameterTangents for a given number of rows.
  struct TangentScratch {
    Matrix velocity_map;                      // rows x num_dofs
    std::vector<std::array<Matrix, 4>> left;  // per network and stage
    std::vector<NetworkWorkspace> network_workspaces;
  };
  TangentScratch MakeTangentScratch(int rows) const;

  // *result += sum_s left_s * (d rate / d theta)_s over up to four stages,
  // with left_s of rows x num_states and result of rows x
  // num_tangent_columns. Networks enter as one small matrix product per layer
  // for all stages together; nothing is allocated.
  void AddParameterTangents(const Prepared& prepared,
                            const Stage* const* stages,
                            const Matrix* const* lefts, int num_stages,
                            TangentScratch* scratch, double* result) const;

  // The same right-hand side on Jets, for derivatives = "jets": `theta` as
  // wide Jets whose values are those of `prepared`.
  void Rate(const Prepared& prepared, double time, const double* input,
            const WideJet* state, const WideJet* theta, WideJet* rate) const;

  // The model with M, C, K corrected by the groups that follow nothing.
  StructuralModel CorrectedModel(const Vector& theta) const;

 private:
  void LinearRate(const Prepared& prepared, double time, const double* input,
                  const double* state, double* rate) const;
  // a += the unknown forces' share; fills stage->unknown_forces.
  void AddUnknownForces(const Prepared& prepared, double time,
                        const double* input, double* a, Stage* stage) const;
  double Followed(const GroupTerm& term, double time,
                  const double* input) const;
  void GatherFeatures(const std::vector<Feature>& features, double time,
                      const double* input, const double* state,
                      double* values) const;
  void RebuildBlocks();
  [[nodiscard]] bool CheckFeatures(const std::string& term,
                                   const std::vector<Feature>& features,
                                   std::string* error) const;

  StructuralModel model_;
  std::vector<InputSpec> inputs_;
  std::vector<GroupTerm> groups_;
  std::vector<LawTerm> laws_;
  std::vector<UnknownForceTerm> unknown_forces_;
  std::vector<NetworkTerm> networks_;
  int num_internal_ = 0;
  int num_parameters_ = 0;
  std::vector<ParameterBlock> blocks_;
  std::vector<int> block_offsets_;
  std::vector<int> tangent_columns_;
  // Offsets in theta and in the tangent columns (-1: none) per term.
  std::vector<int> law_offset_, unknown_force_offset_, network_offset_;
  int group_tangent_ = -1;
  std::vector<int> law_tangent_, unknown_force_tangent_, network_tangent_;
  std::vector<int> law_internal_offset_;
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_STRUCTURAL_DYNAMICS_H_
