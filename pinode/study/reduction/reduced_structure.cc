#include "pinode/study/reduction/reduced_structure.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "pinode/structure/sparse/rigid_body.h"

namespace pinode {
namespace {

// Makes `model` with M_b and K_b.
bool ModelAtBasis(const ReducedStructure& structure, FiniteElementModel* model,
                  std::string* error) {
  *model = structure.exported;
  model->mass = structure.mass_at_basis;
  model->stiffness = structure.stiffness_at_basis;
  if (!structure.removed_dofs.empty()) {
    *model = RemoveDofs(*model, structure.removed_dofs);
  }
  return model->IsValid(error);
}

// Returns the basis with a zero row for each removed DOF; these are ascending.
Matrix WithRemovedDofs(const Matrix& basis, const std::vector<int>& removed) {
  const auto num_removed = static_cast<Eigen::Index>(removed.size());
  Matrix expansion = Matrix::Zero(basis.rows() + num_removed, basis.cols());
  size_t next_removed = 0;
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < expansion.rows(); ++i) {
    if (next_removed < removed.size() && removed[next_removed] == i) {
      ++next_removed;
    } else {
      expansion.row(i) = basis.row(row++);
    }
  }
  return expansion;
}

// T' M_b T and T' K_b T.
struct CoordinatesAtBasis {
  Matrix mass, stiffness;
};

CoordinatesAtBasis AtBasis(const ReducedStructure& structure) {
  return {ReduceMatrix(structure.mass_at_basis, structure.expansion),
          ReduceMatrix(structure.stiffness_at_basis, structure.expansion,
                       structure.reduced.rigid_body_motions)};
}

}  // namespace

bool SetBasisPoint(const std::vector<GroupAtBasis>& groups,
                   ReducedStructure* structure, std::string* error) {
  const std::vector<int>& removed = structure->removed_dofs;
  const int num_dofs = structure->exported.num_dofs();
  const bool ascending =
      std::adjacent_find(removed.begin(), removed.end(),
                         std::greater_equal<int>()) == removed.end();
  if (!ascending ||
      (!removed.empty() &&
       (removed.front() < 0 || removed.back() >= num_dofs)) ||
      static_cast<int>(removed.size()) + structure->model.num_dofs() !=
          num_dofs) {
    *error =
        "the removed DOFs are not those that the model lacks, in the order of "
        "the export";
    return false;
  }
  SparseMatrix mass = structure->exported.mass;
  SparseMatrix stiffness = structure->exported.stiffness;
  structure->basis_at.clear();
  for (const GroupAtBasis& group : groups) {
    SparseMatrix& matrix =
        group.target == MatrixGroup::Target::kMass ? mass : stiffness;
    if (group.matrix == nullptr || group.matrix->rows() != matrix.rows() ||
        group.matrix->cols() != matrix.cols()) {
      *error = "the group's matrix is not over all DOFs of the export";
      return false;
    }
    matrix = SparseMatrix(matrix + group.alpha * *group.matrix);
    structure->basis_at[group.name] = group.alpha;
  }
  structure->mass_at_basis = std::move(mass);
  structure->stiffness_at_basis = std::move(stiffness);
  FiniteElementModel at;
  return groups.empty() || ModelAtBasis(*structure, &at, error);
}

bool Reduce(ReducedStructure* structure, std::string* error) {
  ReducedModel& reduced = structure->reduced;
  const bool at_export = structure->basis_at.empty();
  FiniteElementModel at;
  if (!at_export && !ModelAtBasis(*structure, &at, error)) return false;
  if (!ReduceModel(at_export ? structure->model : at, structure->options,
                   &reduced, error)) {
    return false;
  }
  if (!at_export) {
    reduced.mass = ReduceMatrix(structure->model.mass, reduced.basis);
    reduced.stiffness = ReduceMatrix(structure->model.stiffness, reduced.basis,
                                     reduced.rigid_body_motions);
  }
  structure->notes = structure->export_notes;
  for (const auto* notes : {&reduced.whole_modes.notes, &reduced.notes}) {
    structure->notes.insert(structure->notes.end(), notes->begin(),
                            notes->end());
  }
  structure->expansion =
      WithRemovedDofs(reduced.basis, structure->removed_dofs);
  return true;
}

bool MakeReducedModel(ReducedStructure* structure, StructuralModel* model,
                      std::string* error) {
  const ReducedModel& reduced = structure->reduced;
  const auto num_directions =
      static_cast<Eigen::Index>(structure->directions.size());
  if (structure->influence.rows() != structure->model.num_dofs() ||
      structure->influence.cols() != num_directions) {
    *error =
        "the influence vectors do not have one entry per DOF for each "
        "direction";
    return false;
  }
  StructuralModel result =
      MakeStructuralModel(reduced.mass, reduced.damping, reduced.stiffness,
                          reduced.coordinate_names);
  result.directions = structure->directions;
  const ReducedInfluence ground =
      ReduceInfluence(structure->model, reduced, structure->influence);
  result.influence = ground.influence;
  result.support_mass_coupling = ground.support_mass_coupling;
  if (structure->given_support_mass_coupling.size() > 0) {
    result.support_mass_coupling = structure->given_support_mass_coupling;
  }
  structure->damping = structure->exported.damping;
  if (structure->damping_rule.has_value()) {
    const DampingRule& rule = *structure->damping_rule;
    const CoordinatesAtBasis at = AtBasis(*structure);
    if (!DampingBy(rule, at.mass, at.stiffness, &result.damping, error)) {
      return false;
    }
    const Eigen::Index n = structure->exported.num_dofs();
    if (rule.kind == DampingRule::Kind::kNone) {
      structure->damping = SparseMatrix(n, n);
    } else if (rule.kind == DampingRule::Kind::kRayleigh) {
      structure->damping =
          rule.rayleigh.mass * structure->mass_at_basis +
          rule.rayleigh.stiffness * structure->stiffness_at_basis;
    }
  }
  *model = std::move(result);
  return true;
}

bool GroupInBasis(const ReducedStructure& structure,
                  ReducedStructure::Group* group, Matrix* matrix,
                  std::string* error) {
  using InBasis = ReducedStructure::Group::InBasis;
  switch (group->in_basis) {
    case InBasis::kSame:
      return true;
    case InBasis::kOfModes: {
      const CoordinatesAtBasis at = AtBasis(structure);
      return DampingOfModes(at.mass, at.stiffness, group->first_mode,
                            group->last_mode, group->scale, matrix, error);
    }
    case InBasis::kOfMass:
      group->matrix = group->scale * structure.mass_at_basis;
      break;
    case InBasis::kOfStiffness:
      group->matrix = group->scale * structure.stiffness_at_basis;
      break;
    case InBasis::kReduced:
      break;
  }
  *matrix = ReduceMatrix(group->matrix, structure.expansion,
                         structure.reduced.rigid_body_motions);
  return true;
}

ReducedStructure::Group SpringGroup(const ReducedStructure& structure,
                                    double scale, int from, int to) {
  ReducedStructure::Group group;
  // Coordinates are the kept DOFs, then modes.
  const std::vector<std::string>& kept = structure.options.kept_dofs;
  std::vector<int> ends;
  for (const int coordinate : {from, to}) {
    if (coordinate < 0) continue;
    const size_t place = static_cast<size_t>(coordinate);
    if (place >= kept.size()) return group;
    ends.push_back(structure.exported.DofIndex(kept[place]));
  }
  const int n = structure.exported.num_dofs();
  std::vector<Eigen::Triplet<double>> entries;
  for (const int a : ends) {
    for (const int b : ends)
      entries.emplace_back(a, b, a == b ? scale : -scale);
  }
  group.matrix.resize(n, n);
  group.matrix.setFromTriplets(entries.begin(), entries.end());
  return group;
}

}  // namespace pinode
