#include "pinode/dynamics/group_term.h"

#include <ceres/jet.h>

#include <utility>

#include "pinode/dynamics/products.h"

namespace pinode {
namespace {

using Follows = GroupTerm::Follows;
using Target = MatrixGroup::Target;

size_t GroupIndex(int i) { return static_cast<size_t>(i); }

// Returns the factor of alpha.
double FollowedValue(const GroupTerm& group, double time, const double* input) {
  switch (group.follows) {
    case Follows::kNothing:
      return 1.0;
    case Follows::kTime:
      return time - group.reference;
    case Follows::kCovariate:
      return input[group.input] - group.reference;
  }
  return 1.0;
}

// Data of the groups that follow something, in their order.
struct PreparedGroups : TermPrepared {
  std::vector<Matrix> maps;  // -M^-1 matrix
};

struct LinearizedGroups : TermLinearization {
  Matrix accelerations;  // num_dofs x groups: by a unit alpha
};

struct GroupScratch : TermTangentScratch {
  Vector column;  // rows
};

// Computes the acceleration for a unit alpha.
template <typename T>
void AddUnitAcceleration(const GroupTerm& group, const Matrix& map,
                         const TermPoint<T>& at, T* acceleration) {
  AddProduct(map,
             group.group.target == Target::kDamping ? at.velocity()
                                                    : at.displacement(),
             acceleration);
  const double value = FollowedValue(group, at.time, at.input);
  for (int i = 0; i < at.place.num_dofs; ++i) acceleration[i] *= value;
}

// A mass cannot follow anything, so a group that follows something is a force.
template <typename T>
void AddGroupAcceleration(const T& alpha, const T* unit, int num_dofs,
                          TermRate<T>* rate) {
  for (int i = 0; i < num_dofs; ++i) {
    rate->acceleration[i] += alpha * unit[i];
    rate->force_acceleration[i] += alpha * unit[i];
  }
}

}  // namespace

bool GroupTerms::Add(GroupTerm group, const StructuralModel& model,
                     int num_inputs, std::string* error) {
  group.alpha.name = group.group.name;
  GroupTerms alone;
  alone.groups_ = {group};
  alone.block_.name = "groups";
  alone.block_.parameters = {group.alpha};
  if (!alone.IsValid(model, num_inputs, error)) return false;
  for (const GroupTerm& other : groups_) {
    if (other.group.name == group.group.name) {
      *error = "group '" + group.group.name + "' is defined twice";
      return false;
    }
  }
  if (group.follows != Follows::kNothing) {
    following_.push_back(static_cast<int>(groups_.size()));
  }
  block_.name = "groups";
  block_.parameters.push_back(group.alpha);
  columns_ = TangentColumns(block_);
  groups_.push_back(std::move(group));
  return true;
}

std::unique_ptr<Term> GroupTerms::Clone() const {
  return std::make_unique<GroupTerms>(*this);
}

bool GroupTerms::IsValid(const StructuralModel& model, int num_inputs,
                         std::string* error) const {
  for (const GroupTerm& group : groups_) {
    if (!group.group.IsValid(model.dof_names, error)) return false;
    if (group.follows != Follows::kNothing &&
        group.group.target == Target::kMass) {
      *error = "group '" + group.group.name +
               "': a mass cannot follow time or a covariate; only stiffness "
               "and damping can";
      return false;
    }
    if (group.follows == Follows::kCovariate &&
        (group.input < 0 || group.input >= num_inputs)) {
      *error = "group '" + group.group.name + "' follows an unknown covariate";
      return false;
    }
  }
  return block_.IsValid(error);
}

void GroupTerms::SetParameters(const Vector& values) {
  block_.SetValues(values);
  for (size_t j = 0; j < groups_.size(); ++j) {
    groups_[j].alpha.value = values[static_cast<Eigen::Index>(j)];
  }
}

std::vector<MatrixChange> GroupTerms::MatrixChanges() const {
  std::vector<MatrixChange> changes;
  for (size_t j = 0; j < groups_.size(); ++j) {
    if (groups_[j].follows != Follows::kNothing) continue;
    changes.push_back({&groups_[j].group, static_cast<int>(j), columns_[j]});
  }
  return changes;
}

std::unique_ptr<Term> GroupTerms::Averaged(const Conditions& over) const {
  auto averaged = std::make_unique<GroupTerms>(*this);
  averaged->following_.clear();
  for (const int j : following_) {
    GroupTerm& group = averaged->groups_[GroupIndex(j)];
    if (group.follows == Follows::kTime && !over.time.has_value()) {
      averaged->following_.push_back(j);
      continue;
    }
    group.group.matrix *= (group.follows == Follows::kTime
                               ? *over.time
                               : over.inputs.row(group.input).mean()) -
                          group.reference;
    group.follows = Follows::kNothing;
  }
  return averaged;
}

std::unique_ptr<TermPrepared> GroupTerms::Prepare(
    const LinearSystem& linear, const double* /*parameters*/) const {
  auto prepared = std::make_unique<PreparedGroups>();
  for (int j : following_) {
    prepared->maps.emplace_back(-linear.mass_inverse *
                                groups_[GroupIndex(j)].group.matrix);
  }
  return prepared;
}

std::unique_ptr<TermLinearization> GroupTerms::MakeLinearization(
    const TermPlace& place) const {
  auto linearization = std::make_unique<LinearizedGroups>();
  linearization->accelerations = Matrix::Zero(
      place.num_dofs, static_cast<Eigen::Index>(following_.size()));
  return linearization;
}

void GroupTerms::AddRate(const TermPrepared& prepared,
                         const TermPoint<double>& at, TermRate<double>* rate,
                         TermLinearization* scratch) const {
  const auto& maps = static_cast<const PreparedGroups&>(prepared).maps;
  Matrix& unit = static_cast<LinearizedGroups*>(scratch)->accelerations;
  unit.setZero();
  for (size_t k = 0; k < following_.size(); ++k) {
    const int j = following_[k];
    double* column = unit.col(static_cast<Eigen::Index>(k)).data();
    AddUnitAcceleration(groups_[GroupIndex(j)], maps[k], at, column);
    AddGroupAcceleration(at.parameters[j], column, at.place.num_dofs, rate);
  }
}

void GroupTerms::AddRate(const TermPrepared& prepared,
                         const TermPoint<WideJet>& at,
                         TermRate<WideJet>* rate) const {
  const auto& maps = static_cast<const PreparedGroups&>(prepared).maps;
  for (size_t k = 0; k < following_.size(); ++k) {
    const int j = following_[k];
    std::vector<WideJet> unit(GroupIndex(at.place.num_dofs), WideJet(0.0));
    AddUnitAcceleration(groups_[GroupIndex(j)], maps[k], at, unit.data());
    AddGroupAcceleration(at.parameters[j], unit.data(), at.place.num_dofs,
                         rate);
  }
}

void GroupTerms::Linearize(const TermPrepared& prepared,
                           const TermPoint<double>& at, TermRate<double>* rate,
                           Matrix* jacobian, TermLinearization* kept) const {
  AddRate(prepared, at, rate, kept);
  const auto& maps = static_cast<const PreparedGroups&>(prepared).maps;
  const int n = at.place.num_dofs;
  for (size_t k = 0; k < following_.size(); ++k) {
    const int j = following_[k];
    const GroupTerm& group = groups_[GroupIndex(j)];
    const int shift = group.group.target == Target::kDamping ? n : 0;
    jacobian->block(n, shift, n, n) +=
        at.parameters[j] * FollowedValue(group, at.time, at.input) * maps[k];
  }
}

std::unique_ptr<TermTangentScratch> GroupTerms::MakeTangentScratch(
    const TermPlace& /*place*/, int rows) const {
  auto scratch = std::make_unique<GroupScratch>();
  scratch->column = Vector::Zero(rows);
  return scratch;
}

void GroupTerms::AddParameterTangents(
    const TermPlace& place, const TermPrepared& /*prepared*/,
    const TermLinearization* const* stages, const Matrix* const* lefts,
    int num_stages, TermTangentScratch* scratch, double* result) const {
  const int n = place.num_dofs;
  Vector& column = static_cast<GroupScratch*>(scratch)->column;
  for (size_t k = 0; k < following_.size(); ++k) {
    const int to = columns_[GroupIndex(following_[k])];
    if (to < 0) continue;
    for (int s = 0; s < num_stages; ++s) {
      const auto& kept = static_cast<const LinearizedGroups&>(*stages[s]);
      column.noalias() = lefts[s]->middleCols(n, n) *
                         kept.accelerations.col(static_cast<Eigen::Index>(k));
      Eigen::Map<Vector>(result + column.size() * to, column.size()) += column;
    }
  }
}

}  // namespace pinode
