#include "pinode/dynamics/linear_dynamics.h"

#include <ceres/jet.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "pinode/base/entries_in_use.h"
#include "pinode/base/logging.h"
#include "pinode/base/power_of_two.h"
#include "pinode/dynamics/prescribed_motion.h"
#include "pinode/dynamics/products.h"

namespace pinode {
namespace {

using Target = MatrixGroup::Target;

Matrix* TargetMatrix(Target target, LinearSystem* system) {
  switch (target) {
    case Target::kMass:
      return &system->mass;
    case Target::kDamping:
      return &system->damping;
    case Target::kStiffness:
      return &system->stiffness;
  }
  return nullptr;
}

}  // namespace

LinearDynamics::LinearDynamics(StructuralModel model,
                               std::vector<InputSpec> inputs)
    : model_(std::move(model)), inputs_(std::move(inputs)) {
  std::string error;
  CHECK(IsValid(model_, inputs_, &error)) << error;
}

bool LinearDynamics::IsValid(const StructuralModel& model,
                             const std::vector<InputSpec>& inputs,
                             std::string* error) {
  if (!model.IsValid(error)) return false;
  for (const InputSpec& input : inputs) {
    switch (input.kind) {
      case InputSpec::Kind::kGroundAcceleration:
      case InputSpec::Kind::kGroundDisplacement:
        if (input.index < 0 || input.index >= model.num_directions()) {
          *error = "input '" + input.name + "' needs a direction of the model";
          return false;
        }
        break;
      case InputSpec::Kind::kForce:
      case InputSpec::Kind::kPrescribedDisplacement:
      case InputSpec::Kind::kPrescribedVelocity:
      case InputSpec::Kind::kPrescribedAcceleration:
        if (input.index < 0 || input.index >= model.num_dofs()) {
          *error = "input '" + input.name + "' needs a DOF of the model";
          return false;
        }
        break;
      case InputSpec::Kind::kCovariate:
      case InputSpec::Kind::kRecordSwitch:
        break;
    }
  }
  return ArePrescribable(model, inputs, error);
}

void LinearDynamics::SetChanges(std::vector<MatrixChange> changes) {
  changes_ = std::move(changes);
  free_changes_.clear();
  for (const MatrixChange& change : changes_) {
    if (change.column >= 0) free_changes_.push_back(change);
  }
}

StructuralModel LinearDynamics::ChangedModel(const Vector& theta) const {
  std::vector<MatrixGroup> groups;
  Vector alphas(static_cast<Eigen::Index>(changes_.size()));
  for (const MatrixChange& change : changes_) {
    alphas[static_cast<Eigen::Index>(groups.size())] = theta[change.parameter];
    groups.push_back(*change.group);
  }
  return ApplyGroups(model_, groups, alphas);
}

bool LinearDynamics::Prepare(const Vector& theta, LinearSystem* system,
                             std::string* error) const {
  const int n = num_dofs();
  system->mass = model_.mass;
  system->damping = model_.damping;
  system->stiffness = model_.stiffness;
  for (const MatrixChange& change : changes_) {
    *TargetMatrix(change.group->target, system) +=
        theta[change.parameter] * change.group->matrix;
  }
  // Scaling gives the roots of the same numbers in any unit of mass.
  const double unit =
      n > 0 ? PowerOfTwoBelow(system->mass.diagonal().maxCoeff()) : 1.0;
  const Eigen::LLT<Matrix> factor(Matrix(system->mass / unit));
  if (!system->mass.allFinite() || factor.info() != Eigen::Success) {
    *error = "the corrected mass matrix is not positive definite";
    return false;
  }
  system->mass_inverse = factor.solve(Matrix::Identity(n, n)) / unit;

  Matrix force = Matrix::Zero(n, num_inputs());  // per unit input
  for (int i = 0; i < num_inputs(); ++i) {
    const InputSpec& input = inputs_[static_cast<size_t>(i)];
    if (input.kind == InputSpec::Kind::kGroundAcceleration) {
      force.col(i) = -(system->mass * model_.influence.col(input.index) +
                       model_.support_mass_coupling.col(input.index));
    } else if (input.kind == InputSpec::Kind::kForce) {
      force(input.index, i) = 1.0;
    }
  }
  system->input_map = system->mass_inverse * force;

  Matrix& jacobian = system->state_jacobian;
  jacobian = Matrix::Zero(2 * n, 2 * n);
  jacobian.block(0, n, n, n).setIdentity();
  jacobian.block(n, 0, n, n) = -system->mass_inverse * system->stiffness;
  jacobian.block(n, n, n, n) = -system->mass_inverse * system->damping;
  return true;
}

template <typename T>
void LinearDynamics::RateOf(const LinearSystem& system, const double* input,
                            const T* state, T* rate) const {
  const int n = num_dofs();
  for (int i = 0; i < n; ++i) {
    rate[i] = state[n + i];
    rate[n + i] = T(0.0);
  }
  AddProduct(system.input_map, input, rate + n);
  AddProduct(system.state_jacobian.bottomRows(n), state, rate + n);
}

void LinearDynamics::Rate(const LinearSystem& system, const double* input,
                          const double* state, double* rate) const {
  RateOf(system, input, state, rate);
}

void LinearDynamics::Rate(const LinearSystem& system, const double* input,
                          const WideJet* state, WideJet* rate) const {
  RateOf(system, input, state, rate);
}

double LinearDynamics::GroundAcceleration(int dof, const double* input) const {
  double sum = 0.0;
  for (int i = 0; i < num_inputs(); ++i) {
    const InputSpec& spec = inputs_[static_cast<size_t>(i)];
    if (spec.kind != InputSpec::Kind::kGroundAcceleration) continue;
    sum += model_.influence(dof, spec.index) * input[i];
  }
  return sum;
}

// Uses M a_f = f(theta) with M = M(theta). The values need only the existing
// inverse: a_f = M_value^-1 (f - (M - M_value) a_f), likewise for C and K.
void LinearDynamics::AddVariation(const LinearSystem& system,
                                  const double* input, const WideJet* state,
                                  const WideJet* theta,
                                  const WideJet* force_acceleration,
                                  WideJet* acceleration) const {
  const int n = num_dofs();
  std::vector<WideJet> inertia(static_cast<size_t>(n));  // a_f + r a_g
  for (int i = 0; i < n; ++i) {
    inertia[static_cast<size_t>(i)] =
        WideJet(force_acceleration[i].a + GroundAcceleration(i, input));
  }
  std::vector<WideJet> force(static_cast<size_t>(n), WideJet(0.0));
  for (const MatrixChange& change : changes_) {
    const WideJet& p = theta[change.parameter];
    const Target target = change.group->target;
    std::vector<WideJet> product(static_cast<size_t>(n), WideJet(0.0));
    AddProduct(change.group->matrix,
               target == Target::kMass      ? inertia.data()
               : target == Target::kDamping ? state + n
                                            : state,
               product.data());
    for (size_t i = 0; i < product.size(); ++i) {
      force[i] -= (p - p.a) * product[i];
    }
  }
  AddProduct(system.mass_inverse, force.data(), acceleration);
}

void LinearDynamics::ChangeForces(const double* input, const double* state,
                                  const Vector& force_acceleration,
                                  Matrix* forces) const {
  const int n = num_dofs();
  for (int j = 0; j < num_free_changes(); ++j) {
    const MatrixGroup& group = *free_changes_[static_cast<size_t>(j)].group;
    auto force = forces->col(j);
    switch (group.target) {
      case Target::kMass:
        force.noalias() = group.matrix * force_acceleration;
        // The ground's inertia force depends on the mass too.
        for (int i = 0; i < num_inputs(); ++i) {
          const InputSpec& spec = inputs_[static_cast<size_t>(i)];
          if (spec.kind != InputSpec::Kind::kGroundAcceleration) continue;
          force.noalias() +=
              group.matrix.lazyProduct(model_.influence.col(spec.index)) *
              input[i];
        }
        break;
      case Target::kDamping:
        force.noalias() = group.matrix * Eigen::Map<const Vector>(state + n, n);
        break;
      case Target::kStiffness:
        force.noalias() = group.matrix * Eigen::Map<const Vector>(state, n);
        break;
    }
  }
}

LinearDynamics::TangentScratch LinearDynamics::MakeTangentScratch(
    int rows) const {
  TangentScratch scratch;
  scratch.velocity_map = Matrix::Zero(rows, num_dofs());
  scratch.product = Matrix::Zero(rows, num_free_changes());
  return scratch;
}

void LinearDynamics::AddParameterTangents(const LinearSystem& system,
                                          const Matrix& forces,
                                          const Matrix& left,
                                          TangentScratch* scratch,
                                          double* result) const {
  if (free_changes_.empty()) return;
  const int n = num_dofs();
  scratch->velocity_map.noalias() = left.middleCols(n, n) * system.mass_inverse;
  scratch->product.noalias() = scratch->velocity_map * forces;
  for (int j = 0; j < num_free_changes(); ++j) {
    const MatrixChange& change = free_changes_[static_cast<size_t>(j)];
    Eigen::Map<Vector>(result + left.rows() * change.column, left.rows()) -=
        change.factor * scratch->product.col(j);
  }
}

void LinearDynamics::AddRateDerivatives(
    const LinearSystem& system, std::vector<Matrix>* derivatives) const {
  const int n = num_dofs();
  for (const MatrixChange& change : free_changes_) {
    const Matrix& matrix = change.group->matrix;
    const std::vector<int> rows = RowsInUse(matrix);
    const std::vector<int> columns = ColumnsInUse(matrix);
    const Matrix core = matrix(rows, columns);
    const Matrix left =
        -change.factor * system.mass_inverse(Eigen::all, rows) * core;
    auto accelerations =
        (*derivatives)[static_cast<size_t>(change.column)].bottomRows(n);
    if (change.group->target != Target::kMass) {
      const int first = change.group->target == Target::kDamping ? n : 0;
      for (size_t k = 0; k < columns.size(); ++k) {
        accelerations.col(first + columns[k]) +=
            left.col(static_cast<Eigen::Index>(k));
      }
      continue;
    }
    // a_f + r a_g of each state and input.
    Matrix inertia(n, 2 * n + num_inputs());
    inertia << system.state_jacobian.bottomRows(n), system.input_map;
    for (int i = 0; i < num_inputs(); ++i) {
      const InputSpec& spec = inputs_[static_cast<size_t>(i)];
      if (spec.kind != InputSpec::Kind::kGroundAcceleration) continue;
      inertia.col(2 * n + i) += model_.influence.col(spec.index);
    }
    accelerations += left * inertia(columns, Eigen::all);
  }
}

}  // namespace pinode
