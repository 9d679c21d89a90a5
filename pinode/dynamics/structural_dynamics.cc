#include "pinode/dynamics/structural_dynamics.h"

#include <ceres/jet.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/network/network_functor.h"

namespace pinode {
namespace {

size_t Index(int i) { return static_cast<size_t>(i); }

// Scatters d(feature)/d(state) times a coefficient vector into the Jacobian:
// jacobian.col(state) += sign * column.
template <typename Column>
void AddFeatureColumn(const Feature& feature, int num_dofs,
                      const Column& column, Matrix* jacobian) {
  const int shift = feature.OnVelocity() ? num_dofs : 0;
  switch (feature.kind) {
    case Feature::Kind::kDisplacement:
    case Feature::Kind::kVelocity:
      jacobian->col(shift + feature.a) += column;
      break;
    case Feature::Kind::kDeformation:
    case Feature::Kind::kDeformationRate:
      if (feature.a != Feature::kGround) {
        jacobian->col(shift + feature.a) -= column;
      }
      if (feature.b != Feature::kGround) {
        jacobian->col(shift + feature.b) += column;
      }
      break;
    case Feature::Kind::kTime:
    case Feature::Kind::kInput:
      break;
  }
}

template <typename T>
T FeatureValue(const Feature& feature, int num_dofs, double time,
               const double* input, const T* state) {
  const T* part = feature.OnVelocity() ? state + num_dofs : state;
  switch (feature.kind) {
    case Feature::Kind::kDisplacement:
    case Feature::Kind::kVelocity:
      return part[feature.a];
    case Feature::Kind::kDeformation:
    case Feature::Kind::kDeformationRate: {
      T value(0.0);
      if (feature.b != Feature::kGround) value += part[feature.b];
      if (feature.a != Feature::kGround) value -= part[feature.a];
      return value;
    }
    case Feature::Kind::kTime:
      return T(time);
    case Feature::Kind::kInput:
      return T(input[feature.input]);
  }
  return T(0.0);
}

}  // namespace

StructuralDynamics::StructuralDynamics(StructuralModel model,
                                       std::vector<InputSpec> inputs)
    : model_(std::move(model)), inputs_(std::move(inputs)) {
  std::string error;
  CHECK(model_.IsValid(&error)) << error;
  for (const InputSpec& input : inputs_) {
    switch (input.kind) {
      case InputSpec::Kind::kGroundAcceleration:
      case InputSpec::Kind::kGroundDisplacement:
        CHECK(input.index >= 0 && input.index < model_.num_directions())
            << "input '" << input.name << "' needs a direction of the model";
        break;
      case InputSpec::Kind::kForce:
        CHECK(input.index >= 0 && input.index < num_dofs())
            << "input '" << input.name << "' needs a DOF of the model";
        break;
      case InputSpec::Kind::kCovariate:
      case InputSpec::Kind::kRecordSwitch:
        break;
    }
  }
}

bool StructuralDynamics::CheckFeatures(const std::string& term,
                                       const std::vector<Feature>& features,
                                       std::string* error) const {
  for (const Feature& feature : features) {
    bool fits = true;
    switch (feature.kind) {
      case Feature::Kind::kDisplacement:
      case Feature::Kind::kVelocity:
        fits = feature.a >= 0 && feature.a < num_dofs();
        break;
      case Feature::Kind::kDeformation:
      case Feature::Kind::kDeformationRate:
        fits = feature.a >= Feature::kGround && feature.a < num_dofs() &&
               feature.b >= Feature::kGround && feature.b < num_dofs() &&
               feature.a != feature.b;
        break;
      case Feature::Kind::kTime:
        break;
      case Feature::Kind::kInput:
        fits = feature.input >= 0 && feature.input < num_inputs();
        break;
    }
    if (!fits) {
      *error = "'" + term + "' looks at a DOF or an input that does not exist";
      return false;
    }
  }
  return true;
}

bool StructuralDynamics::AddGroup(GroupTerm term, std::string* error) {
  if (!term.group.IsValid(model_.dof_names, error)) return false;
  for (const GroupTerm& other : groups_) {
    if (other.group.name == term.group.name) {
      *error = "group '" + term.group.name + "' is defined twice";
      return false;
    }
  }
  if (term.follows != GroupTerm::Follows::kNothing &&
      term.group.target == MatrixGroup::Target::kMass) {
    *error = "group '" + term.group.name +
             "': a mass cannot follow time or a covariate; only stiffness and "
             "damping can";
    return false;
  }
  if (term.follows == GroupTerm::Follows::kCovariate &&
      (term.input < 0 || term.input >= num_inputs())) {
    *error = "group '" + term.group.name + "' follows an unknown covariate";
    return false;
  }
  term.alpha.name = term.group.name;
  ParameterBlock check;
  check.name = "groups";
  check.parameters = {term.alpha};
  if (!check.IsValid(error)) return false;
  groups_.push_back(std::move(term));
  RebuildBlocks();
  return true;
}

bool StructuralDynamics::AddLaw(LawTerm term, std::string* error) {
  CHECK(term.law != nullptr) << "'" << term.name << "' has no law";
  if (!CheckFeatures(term.name, term.features, error)) return false;
  if (static_cast<int>(term.features.size()) != term.law->num_features() ||
      term.parameters.size() != term.law->num_parameters() ||
      term.outputs.rows() != num_dofs() ||
      term.outputs.cols() != term.law->num_outputs()) {
    *error = "'" + term.name +
             "': numbers of features, parameters or outputs do not fit its law";
    return false;
  }
  if (!term.parameters.IsValid(error)) return false;
  num_internal_ += term.law->num_internal();
  laws_.push_back(std::move(term));
  RebuildBlocks();
  return true;
}

bool StructuralDynamics::AddUnknownForce(UnknownForceTerm term,
                                         std::string* error) {
  CHECK(term.history != nullptr) << "'" << term.name << "' has no history";
  if (term.outputs.size() != num_dofs() ||
      term.parameters.size() != term.history->num_parameters()) {
    *error = "'" + term.name +
             "': numbers of DOFs or parameters do not fit the force";
    return false;
  }
  if (term.input < -1 || term.input >= num_inputs()) {
    *error = "'" + term.name + "' looks at an input that does not exist";
    return false;
  }
  for (const CombinationPrior::Combination& c : term.prior.combinations) {
    CHECK(c.first >= 0 && c.group >= 0 && c.group < term.prior.num_groups() &&
          c.first + c.weights.size() <= term.parameters.size())
        << "'" << term.name << "': its prior does not fit its parameters";
  }
  if (!term.parameters.IsValid(error)) return false;
  unknown_forces_.push_back(std::move(term));
  RebuildBlocks();
  return true;
}

bool StructuralDynamics::AddNetwork(NetworkTerm term, std::string* error) {
  CHECK(term.network != nullptr) << "'" << term.name << "' has no network";
  if (!CheckFeatures(term.name, term.features, error)) return false;
  const NetworkArchitecture& architecture = term.network->architecture();
  if (static_cast<int>(term.features.size()) != architecture.num_inputs ||
      term.weights.size() != architecture.NumWeights() ||
      term.outputs.rows() != num_dofs() ||
      term.outputs.cols() != architecture.num_outputs) {
    *error = "'" + term.name +
             "': numbers of inputs, weights or outputs do not fit its "
             "architecture";
    return false;
  }
  term.weights.named = false;
  if (!term.weights.IsValid(error)) return false;
  networks_.push_back(std::move(term));
  RebuildBlocks();
  return true;
}

void StructuralDynamics::RebuildBlocks() {
  blocks_.clear();
  block_offsets_.clear();
  tangent_columns_.clear();
  law_offset_.clear();
  law_tangent_.clear();
  unknown_force_offset_.clear();
  unknown_force_tangent_.clear();
  network_offset_.clear();
  network_tangent_.clear();
  law_internal_offset_.clear();
  num_parameters_ = 0;
  // Returns the block's first tangent column, -1 where nothing is free.
  const auto add = [this](const ParameterBlock& block) {
    blocks_.push_back(block);
    block_offsets_.push_back(num_parameters_);
    bool any_free = false;
    for (const Parameter& p : block.parameters) any_free = any_free || p.free;
    const int first = any_free ? num_tangent_columns() : -1;
    for (int i = 0; any_free && i < block.size(); ++i) {
      tangent_columns_.push_back(num_parameters_ + i);
    }
    num_parameters_ += block.size();
    return first;
  };
  group_tangent_ = -1;
  if (!groups_.empty()) {
    ParameterBlock block;
    block.name = "groups";
    for (const GroupTerm& term : groups_) {
      block.parameters.push_back(term.alpha);
    }
    group_tangent_ = add(block);
  }
  int internal = 2 * num_dofs();
  for (const LawTerm& term : laws_) {
    law_offset_.push_back(num_parameters_);
    law_tangent_.push_back(add(term.parameters));
    law_internal_offset_.push_back(internal);
    internal += term.law->num_internal();
  }
  for (const UnknownForceTerm& term : unknown_forces_) {
    unknown_force_offset_.push_back(num_parameters_);
    unknown_force_tangent_.push_back(add(term.parameters));
  }
  for (const NetworkTerm& term : networks_) {
    network_offset_.push_back(num_parameters_);
    network_tangent_.push_back(add(term.weights));
  }
}

std::vector<std::string> StructuralDynamics::StateNames() const {
  std::vector<std::string> names;
  for (const std::string& dof : model_.dof_names) {
    names.push_back("x[" + dof + "]");
  }
  for (const std::string& dof : model_.dof_names) {
    names.push_back("v[" + dof + "]");
  }
  for (const LawTerm& term : laws_) {
    const int count = term.law->num_internal();
    for (int i = 0; i < count; ++i) {
      names.push_back("z[" + term.name +
                      (count > 1 ? "," + std::to_string(i + 1) : "") + "]");
    }
  }
  return names;
}

Vector StructuralDynamics::Parameters() const {
  Vector theta(num_parameters_);
  for (size_t b = 0; b < blocks_.size(); ++b) {
    theta.segment(block_offsets_[b], blocks_[b].size()) = blocks_[b].Values();
  }
  return theta;
}

void StructuralDynamics::SetParameters(const Vector& theta) {
  CHECK_EQ(theta.size(), num_parameters_);
  for (size_t j = 0; j < groups_.size(); ++j) {
    groups_[j].alpha.value = theta[static_cast<int>(j)];
  }
  for (size_t j = 0; j < laws_.size(); ++j) {
    ParameterBlock& block = laws_[j].parameters;
    block.SetValues(theta.segment(law_offset_[j], block.size()));
  }
  for (size_t j = 0; j < unknown_forces_.size(); ++j) {
    ParameterBlock& block = unknown_forces_[j].parameters;
    block.SetValues(theta.segment(unknown_force_offset_[j], block.size()));
  }
  for (size_t j = 0; j < networks_.size(); ++j) {
    ParameterBlock& block = networks_[j].weights;
    block.SetValues(theta.segment(network_offset_[j], block.size()));
  }
  RebuildBlocks();
}

bool StructuralDynamics::Prepare(const Vector& theta, Prepared* prepared,
                                 std::string* error) const {
  CHECK_EQ(theta.size(), num_parameters_);
  const int n = num_dofs();
  prepared->theta = theta;
  prepared->mass = model_.mass;
  prepared->damping = model_.damping;
  prepared->stiffness = model_.stiffness;
  for (size_t j = 0; j < groups_.size(); ++j) {
    const GroupTerm& term = groups_[j];
    if (term.follows != GroupTerm::Follows::kNothing) continue;
    const double alpha = theta[static_cast<int>(j)];
    switch (term.group.target) {
      case MatrixGroup::Target::kMass:
        prepared->mass += alpha * term.group.matrix;
        break;
      case MatrixGroup::Target::kDamping:
        prepared->damping += alpha * term.group.matrix;
        break;
      case MatrixGroup::Target::kStiffness:
        prepared->stiffness += alpha * term.group.matrix;
        break;
    }
  }
  const Eigen::LLT<Matrix> factor(prepared->mass);
  if (!prepared->mass.allFinite() || factor.info() != Eigen::Success) {
    *error = "the corrected mass matrix is not positive definite";
    return false;
  }
  prepared->mass_inverse = factor.solve(Matrix::Identity(n, n));

  prepared->input_force = Matrix::Zero(n, num_inputs());
  for (int i = 0; i < num_inputs(); ++i) {
    const InputSpec& input = inputs_[Index(i)];
    if (input.kind == InputSpec::Kind::kGroundAcceleration) {
      prepared->input_force.col(i) =
          -(prepared->mass * model_.influence.col(input.index) +
            model_.support_mass_coupling.col(input.index));
    } else if (input.kind == InputSpec::Kind::kForce) {
      prepared->input_force(input.index, i) = 1.0;
    }
  }
  prepared->input_map = prepared->mass_inverse * prepared->input_force;

  Matrix& jacobian = prepared->state_jacobian;
  jacobian = Matrix::Zero(num_states(), num_states());
  jacobian.block(0, n, n, n).setIdentity();
  jacobian.block(n, 0, n, n) = -prepared->mass_inverse * prepared->stiffness;
  jacobian.block(n, n, n, n) = -prepared->mass_inverse * prepared->damping;

  prepared->law_map.resize(laws_.size());
  for (size_t j = 0; j < laws_.size(); ++j) {
    if (laws_[j].acts_as == ActsAs::kForce) {
      prepared->law_map[j] = -prepared->mass_inverse * laws_[j].outputs;
    } else {
      prepared->law_map[j] = laws_[j].outputs;
    }
  }
  prepared->unknown_force_map.resize(unknown_forces_.size());
  for (size_t j = 0; j < unknown_forces_.size(); ++j) {
    prepared->unknown_force_map[j] =
        prepared->mass_inverse * unknown_forces_[j].outputs;
  }
  prepared->network_map.resize(networks_.size());
  for (size_t j = 0; j < networks_.size(); ++j) {
    const NetworkTerm& term = networks_[j];
    if (term.acts_as == NetworkTerm::ActsAs::kForce) {
      prepared->network_map[j] = -prepared->mass_inverse * term.outputs;
    } else {
      prepared->network_map[j] = term.outputs;
    }
  }
  return true;
}

StructuralDynamics::Stage StructuralDynamics::MakeStage() const {
  const int n = num_dofs();
  Stage stage;
  stage.rate = Vector::Zero(num_states());
  stage.jacobian = Matrix::Zero(num_states(), num_states());
  stage.force_acceleration = Vector::Zero(n);
  stage.group_forces = Matrix::Zero(n, static_cast<int>(groups_.size()));
  int features = 1;
  int outputs = 1;
  for (const LawTerm& term : laws_) {
    features = std::max(features, term.law->num_features());
    outputs = std::max(outputs, term.law->num_results());
    // Row-major results x arguments is the transpose, column-major.
    stage.law_jacobians.emplace_back(
        Matrix::Zero(term.law->num_arguments(), term.law->num_results()));
  }
  stage.unknown_forces.resize(unknown_forces_.size());
  for (const NetworkTerm& term : networks_) {
    const NetworkArchitecture& architecture = term.network->architecture();
    features = std::max(features, architecture.num_inputs);
    outputs = std::max(outputs, architecture.num_outputs);
    stage.network_tangents.emplace_back(*term.network);
    stage.network_workspaces.emplace_back(*term.network);
  }
  stage.features = Vector::Zero(features);
  stage.outputs = Vector::Zero(outputs);
  stage.mapped = Vector::Zero(num_states());
  return stage;
}

void StructuralDynamics::AddUnknownForces(const Prepared& prepared, double time,
                                          const double* input, double* a,
                                          Stage* stage) const {
  Eigen::Map<Vector> acceleration(a, num_dofs());
  for (size_t j = 0; j < unknown_forces_.size(); ++j) {
    const UnknownForceTerm& term = unknown_forces_[j];
    ForceHistory::Local& local = stage->unknown_forces[j];
    const double factor = term.input < 0 ? 1.0 : input[term.input];
    if (factor == 0.0) {
      local = ForceHistory::Local();
      continue;
    }
    local = term.history->Evaluate(
        time, prepared.theta.data() + unknown_force_offset_[j]);
    local.value *= factor;
    for (double& derivative : local.derivatives) derivative *= factor;
    acceleration += prepared.unknown_force_map[j] * local.value;
  }
}

double StructuralDynamics::Followed(const GroupTerm& term, double time,
                                    const double* input) const {
  switch (term.follows) {
    case GroupTerm::Follows::kNothing:
      return 1.0;
    case GroupTerm::Follows::kTime:
      return time - term.reference;
    case GroupTerm::Follows::kCovariate:
      return input[term.input] - term.reference;
  }
  return 1.0;
}

void StructuralDynamics::GatherFeatures(const std::vector<Feature>& features,
                                        double time, const double* input,
                                        const double* state,
                                        double* values) const {
  for (size_t i = 0; i < features.size(); ++i) {
    values[i] = FeatureValue(features[i], num_dofs(), time, input, state);
  }
}

void StructuralDynamics::LinearRate(const Prepared& prepared, double time,
                                    const double* input, const double* state,
                                    double* rate) const {
  const int n = num_dofs();
  Eigen::Map<const Vector> x(state, n);
  Eigen::Map<const Vector> v(state + n, n);
  Eigen::Map<Vector> a(rate + n, n);
  Eigen::Map<Vector>(rate, n) = v;
  a.noalias() =
      prepared.input_map * Eigen::Map<const Vector>(input, num_inputs());
  a.noalias() += prepared.state_jacobian.block(n, 0, n, 2 * n) *
                 Eigen::Map<const Vector>(state, 2 * n);
  for (size_t j = 0; j < groups_.size(); ++j) {
    const GroupTerm& term = groups_[j];
    if (term.follows == GroupTerm::Follows::kNothing) continue;
    const double factor =
        -prepared.theta[static_cast<int>(j)] * Followed(term, time, input);
    const bool damping = term.group.target == MatrixGroup::Target::kDamping;
    // Two small products: followed groups are few, and no scratch is needed.
    for (int row = 0; row < n; ++row) {
      const double force =
          factor * (damping ? term.group.matrix.row(row).dot(v)
                            : term.group.matrix.row(row).dot(x));
      if (force != 0.0) a += prepared.mass_inverse.col(row) * force;
    }
  }
}

void StructuralDynamics::Rate(const Prepared& prepared, double time,
                              const double* input, const double* state,
                              double* rate, Stage* scratch) const {
  const int n = num_dofs();
  LinearRate(prepared, time, input, state, rate);
  Eigen::Map<Vector> a(rate + n, n);
  AddUnknownForces(prepared, time, input, a.data(), scratch);
  for (size_t j = 0; j < laws_.size(); ++j) {
    const LawTerm& term = laws_[j];
    GatherFeatures(term.features, time, input, state, scratch->features.data());
    term.law->Evaluate(
        scratch->features.data(), state + law_internal_offset_[j],
        prepared.theta.data() + law_offset_[j], scratch->outputs.data());
    const int outputs = term.law->num_outputs();
    for (int o = 0; o < outputs; ++o) {
      a += prepared.law_map[j].col(o) * scratch->outputs[o];
    }
    for (int i = 0; i < term.law->num_internal(); ++i) {
      rate[law_internal_offset_[j] + i] = scratch->outputs[outputs + i];
    }
  }
  for (size_t j = 0; j < networks_.size(); ++j) {
    const NetworkTerm& term = networks_[j];
    GatherFeatures(term.features, time, input, state, scratch->features.data());
    term.network->Evaluate(
        scratch->features.data(), prepared.theta.data() + network_offset_[j],
        scratch->outputs.data(), &scratch->network_workspaces[j]);
    for (int o = 0; o < prepared.network_map[j].cols(); ++o) {
      a += prepared.network_map[j].col(o) * scratch->outputs[o];
    }
  }
}

void StructuralDynamics::Linearize(const Prepared& prepared, double time,
                                   const double* input, const double* state,
                                   Stage* stage) const {
  const int n = num_dofs();
  Eigen::Map<const Vector> x(state, n);
  Eigen::Map<const Vector> v(state + n, n);
  LinearRate(prepared, time, input, state, stage->rate.data());
  stage->jacobian = prepared.state_jacobian;
  for (size_t j = 0; j < groups_.size(); ++j) {
    const GroupTerm& term = groups_[j];
    if (term.follows == GroupTerm::Follows::kNothing) continue;
    const double factor =
        -prepared.theta[static_cast<int>(j)] * Followed(term, time, input);
    const int shift =
        term.group.target == MatrixGroup::Target::kDamping ? n : 0;
    // lazyProduct: no temporary for a product this small.
    stage->jacobian.block(n, shift, n, n) +=
        factor * prepared.mass_inverse.lazyProduct(term.group.matrix);
  }

  Eigen::Map<Vector> a(stage->rate.data() + n, n);
  AddUnknownForces(prepared, time, input, a.data(), stage);
  // The mass groups and the sensors refer to the accelerations that forces
  // cause; what acts as an acceleration comes on top.
  stage->force_acceleration = a;
  for (size_t j = 0; j < laws_.size(); ++j) {
    const LawTerm& term = laws_[j];
    const int outputs = term.law->num_outputs();
    const int internal = term.law->num_internal();
    const int features = term.law->num_features();
    const int first = law_internal_offset_[j];
    GatherFeatures(term.features, time, input, state, stage->features.data());
    Matrix& jacobian = stage->law_jacobians[j];  // arguments x results
    term.law->Linearize(stage->features.data(), state + first,
                        prepared.theta.data() + law_offset_[j],
                        stage->outputs.data(), jacobian.data());
    for (int i = 0; i < internal; ++i) {
      stage->rate[first + i] = stage->outputs[outputs + i];
    }
    for (int o = 0; o < outputs; ++o) {
      a += prepared.law_map[j].col(o) * stage->outputs[o];
      if (term.acts_as == ActsAs::kForce) {
        stage->force_acceleration +=
            prepared.law_map[j].col(o) * stage->outputs[o];
      }
    }
    // Column of d rate / d argument, mapped once and scattered.
    for (int argument = 0; argument < features + internal; ++argument) {
      stage->mapped.setZero();
      for (int o = 0; o < outputs; ++o) {
        stage->mapped.segment(n, n) +=
            prepared.law_map[j].col(o) * jacobian(argument, o);
      }
      for (int i = 0; i < internal; ++i) {
        stage->mapped[first + i] = jacobian(argument, outputs + i);
      }
      if (argument < features) {
        AddFeatureColumn(term.features[Index(argument)], n, stage->mapped,
                         &stage->jacobian);
      } else {
        stage->jacobian.col(first + argument - features) += stage->mapped;
      }
    }
  }

  for (size_t j = 0; j < networks_.size(); ++j) {
    const NetworkTerm& term = networks_[j];
    const int outputs = static_cast<int>(term.outputs.cols());
    const int features = static_cast<int>(term.features.size());
    GatherFeatures(term.features, time, input, state, stage->features.data());
    NetworkTangent& tangent = stage->network_tangents[j];
    term.network->Linearize(stage->features.data(),
                            prepared.theta.data() + network_offset_[j],
                            &tangent);
    const Matrix& map = prepared.network_map[j];
    for (int o = 0; o < outputs; ++o) {
      a += map.col(o) * tangent.value()[o];
      if (term.acts_as == NetworkTerm::ActsAs::kForce) {
        stage->force_acceleration += map.col(o) * tangent.value()[o];
      }
    }
    for (int f = 0; f < features; ++f) {
      stage->mapped.setZero();
      for (int o = 0; o < outputs; ++o) {
        stage->mapped.segment(n, n) +=
            map.col(o) * tangent.input_jacobian()(o, f);
      }
      AddFeatureColumn(term.features[Index(f)], n, stage->mapped,
                       &stage->jacobian);
    }
  }

  if (group_tangent_ < 0) return;
  for (size_t j = 0; j < groups_.size(); ++j) {
    const GroupTerm& term = groups_[j];
    auto force = stage->group_forces.col(static_cast<int>(j));
    switch (term.group.target) {
      case MatrixGroup::Target::kMass:
        force.noalias() = term.group.matrix * stage->force_acceleration;
        // The ground's inertia force follows the mass as well.
        for (int i = 0; i < num_inputs(); ++i) {
          if (inputs_[Index(i)].kind != InputSpec::Kind::kGroundAcceleration) {
            continue;
          }
          force.noalias() += term.group.matrix.lazyProduct(model_.influence.col(
                                 inputs_[Index(i)].index)) *
                             input[i];
        }
        break;
      case MatrixGroup::Target::kDamping:
        force.noalias() = term.group.matrix * v;
        force *= Followed(term, time, input);
        break;
      case MatrixGroup::Target::kStiffness:
        force.noalias() = term.group.matrix * x;
        force *= Followed(term, time, input);
        break;
    }
  }
}

StructuralDynamics::TangentScratch StructuralDynamics::MakeTangentScratch(
    int rows) const {
  TangentScratch scratch;
  scratch.velocity_map = Matrix::Zero(rows, num_dofs());
  for (const NetworkTerm& term : networks_) {
    const Matrix zero =
        Matrix::Zero(rows, term.network->architecture().num_outputs);
    scratch.left.push_back({zero, zero, zero, zero});
    scratch.network_workspaces.emplace_back(*term.network, rows, 4);
  }
  return scratch;
}

void StructuralDynamics::AddParameterTangents(const Prepared& prepared,
                                              const Stage* const* stages,
                                              const Matrix* const* lefts,
                                              int num_stages,
                                              TangentScratch* scratch,
                                              double* result) const {
  DCHECK_LE(num_stages, 4);
  const int n = num_dofs();
  const int rows = static_cast<int>(lefts[0]->rows());
  if (group_tangent_ >= 0) {
    Eigen::Map<Matrix> columns(result + rows * group_tangent_, rows,
                               static_cast<int>(groups_.size()));
    for (int s = 0; s < num_stages; ++s) {
      scratch->velocity_map.noalias() =
          lefts[s]->middleCols(n, n) * prepared.mass_inverse;
      columns.noalias() -= scratch->velocity_map * stages[s]->group_forces;
    }
  }
  for (size_t j = 0; j < laws_.size(); ++j) {
    if (law_tangent_[j] < 0) continue;
    const Law& law = *laws_[j].law;
    const int first_parameter = law.num_features() + law.num_internal();
    Eigen::Map<Matrix> columns(result + rows * law_tangent_[j], rows,
                               law.num_parameters());
    for (int s = 0; s < num_stages; ++s) {
      const Matrix& jacobian = stages[s]->law_jacobians[j];
      for (int o = 0; o < law.num_results(); ++o) {
        // velocity_map's first column serves as the mapped output.
        auto mapped = scratch->velocity_map.col(0);
        if (o < law.num_outputs()) {
          mapped.noalias() =
              lefts[s]->middleCols(n, n) * prepared.law_map[j].col(o);
        } else {
          mapped =
              lefts[s]->col(law_internal_offset_[j] + o - law.num_outputs());
        }
        for (int p = 0; p < law.num_parameters(); ++p) {
          columns.col(p) += mapped * jacobian(first_parameter + p, o);
        }
      }
    }
  }
  for (size_t j = 0; j < unknown_forces_.size(); ++j) {
    if (unknown_force_tangent_[j] < 0) continue;
    for (int s = 0; s < num_stages; ++s) {
      const ForceHistory::Local& local = stages[s]->unknown_forces[j];
      if (local.count == 0) continue;
      auto mapped = scratch->velocity_map.col(0);
      mapped.noalias() =
          lefts[s]->middleCols(n, n) * prepared.unknown_force_map[j];
      Eigen::Map<Matrix> columns(
          result + rows * (unknown_force_tangent_[j] + local.first), rows,
          local.count);
      for (int p = 0; p < local.count; ++p) {
        columns.col(p) += mapped * local.derivatives[p];
      }
    }
  }
  for (size_t j = 0; j < networks_.size(); ++j) {
    if (network_tangent_[j] < 0) continue;
    const NetworkTangent* tangents[4];
    const Matrix* network_lefts[4];
    for (int s = 0; s < num_stages; ++s) {
      Matrix& left = scratch->left[j][Index(s)];
      left.noalias() =
          lefts[s]->middleCols(n, n).lazyProduct(prepared.network_map[j]);
      network_lefts[s] = &left;
      tangents[s] = &stages[s]->network_tangents[j];
    }
    networks_[j].network->AddWeightTangents(
        tangents, network_lefts, num_stages, &scratch->network_workspaces[j],
        result + rows * network_tangent_[j]);
  }
}

void StructuralDynamics::Rate(const Prepared& prepared, double time,
                              const double* input, const WideJet* state,
                              const WideJet* theta, WideJet* rate) const {
  using T = WideJet;
  const int n = num_dofs();
  const T* x = state;
  const T* v = state + n;
  // Written with plain loops: they work on Jets without heavy templates.
  const auto add_product = [n](const Matrix& matrix, const T* vector,
                               const T& factor, std::vector<T>* result) {
    for (int i = 0; i < n; ++i) {
      T sum(0.0);
      for (int k = 0; k < n; ++k) {
        if (matrix(i, k) != 0.0) sum += matrix(i, k) * vector[k];
      }
      (*result)[Index(i)] += factor * sum;
    }
  };
  std::vector<T> force(Index(n), T(0.0));
  std::vector<T> ground(Index(n), T(0.0));  // r a_g
  for (int i = 0; i < num_inputs(); ++i) {
    const InputSpec& spec = inputs_[Index(i)];
    if (spec.kind == InputSpec::Kind::kForce) {
      force[Index(spec.index)] += T(input[i]);
    } else if (spec.kind == InputSpec::Kind::kGroundAcceleration) {
      for (int k = 0; k < n; ++k) {
        ground[Index(k)] += T(model_.influence(k, spec.index) * input[i]);
        force[Index(k)] -=
            T(model_.support_mass_coupling(k, spec.index) * input[i]);
      }
    }
  }
  add_product(model_.stiffness, x, T(-1.0), &force);
  add_product(model_.damping, v, T(-1.0), &force);
  add_product(model_.mass, ground.data(), T(-1.0), &force);
  for (size_t j = 0; j < groups_.size(); ++j) {
    const GroupTerm& term = groups_[j];
    const T factor = -theta[j] * Followed(term, time, input);
    switch (term.group.target) {
      case MatrixGroup::Target::kStiffness:
        add_product(term.group.matrix, x, factor, &force);
        break;
      case MatrixGroup::Target::kDamping:
        add_product(term.group.matrix, v, factor, &force);
        break;
      case MatrixGroup::Target::kMass:
        add_product(term.group.matrix, ground.data(), factor, &force);
        break;
    }
  }
  for (size_t j = 0; j < unknown_forces_.size(); ++j) {
    const UnknownForceTerm& term = unknown_forces_[j];
    const double factor = term.input < 0 ? 1.0 : input[term.input];
    if (factor == 0.0) continue;
    const T value =
        factor * term.history->Evaluate(time, theta + unknown_force_offset_[j]);
    for (int i = 0; i < n; ++i) force[Index(i)] += term.outputs[i] * value;
  }
  std::vector<T> on_top(Index(n), T(0.0));
  for (size_t j = 0; j < laws_.size(); ++j) {
    const LawTerm& term = laws_[j];
    std::vector<T> features;
    for (const Feature& feature : term.features) {
      features.push_back(FeatureValue(feature, n, time, input, state));
    }
    std::vector<T> result(Index(term.law->num_results()));
    term.law->Evaluate(features.data(), state + law_internal_offset_[j],
                       theta + law_offset_[j], result.data());
    for (int o = 0; o < term.law->num_outputs(); ++o) {
      for (int i = 0; i < n; ++i) {
        if (term.acts_as == ActsAs::kForce) {
          force[Index(i)] -= term.outputs(i, o) * result[Index(o)];
        } else {
          on_top[Index(i)] += term.outputs(i, o) * result[Index(o)];
        }
      }
    }
    for (int i = 0; i < term.law->num_internal(); ++i) {
      rate[law_internal_offset_[j] + i] =
          result[Index(term.law->num_outputs() + i)];
    }
  }
  for (size_t j = 0; j < networks_.size(); ++j) {
    const NetworkTerm& term = networks_[j];
    std::vector<T> features;
    for (const Feature& feature : term.features) {
      features.push_back(FeatureValue(feature, n, time, input, state));
    }
    const bool is_force = term.acts_as == NetworkTerm::ActsAs::kForce;
    std::vector<T> result(Index(static_cast<int>(term.outputs.cols())));
    EvaluateNetwork(term.network->architecture(), features.data(),
                    theta + network_offset_[j], result.data());
    for (int o = 0; o < term.outputs.cols(); ++o) {
      for (int i = 0; i < n; ++i) {
        if (is_force) {
          force[Index(i)] -= term.outputs(i, o) * result[Index(o)];
        } else {
          on_top[Index(i)] += term.outputs(i, o) * result[Index(o)];
        }
      }
    }
  }
  // M a = force with M = M(theta): the value needs the inverse at hand only;
  // the derivative part of M acts through a = M^-1 (force - (M - M_value) a).
  std::vector<T> a_value(Index(n), T(0.0));
  for (int i = 0; i < n; ++i) {
    double sum = 0.0;
    for (int k = 0; k < n; ++k) {
      sum += prepared.mass_inverse(i, k) * force[Index(k)].a;
    }
    a_value[Index(i)] = T(sum);
  }
  for (size_t j = 0; j < groups_.size(); ++j) {
    if (groups_[j].group.target != MatrixGroup::Target::kMass) continue;
    add_product(groups_[j].group.matrix, a_value.data(),
                T(-(theta[j] - theta[j].a)), &force);
  }
  for (int i = 0; i < n; ++i) {
    T sum(0.0);
    for (int k = 0; k < n; ++k) {
      sum += prepared.mass_inverse(i, k) * force[Index(k)];
    }
    rate[i] = v[i];
    rate[n + i] = sum + on_top[Index(i)];
  }
}

StructuralModel StructuralDynamics::CorrectedModel(const Vector& theta) const {
  CHECK_EQ(theta.size(), num_parameters_);
  std::vector<MatrixGroup> constant;
  std::vector<double> alphas;
  for (size_t j = 0; j < groups_.size(); ++j) {
    if (groups_[j].follows != GroupTerm::Follows::kNothing) continue;
    constant.push_back(groups_[j].group);
    alphas.push_back(theta[static_cast<int>(j)]);
  }
  return ApplyGroups(
      model_, constant,
      Eigen::Map<const Vector>(alphas.data(), static_cast<int>(alphas.size())));
}

}  // namespace pinode
