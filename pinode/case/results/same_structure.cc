#include "pinode/case/results/same_structure.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/case/results/grown_case.h"
#include "pinode/study/reduction/reduced_structure.h"

namespace pinode {
namespace {

using Target = MatrixGroup::Target;

// Returns the index of a group; -1: the dynamics have no such group.
int FindGroup(const StructuralDynamics& dynamics, const std::string& name) {
  for (size_t j = 0; j < dynamics.groups().size(); ++j) {
    if (dynamics.groups()[j].group.name == name) return static_cast<int>(j);
  }
  return -1;
}

}  // namespace

std::vector<ComparedMatrix> ComparedMatrices(const Case& c) {
  const StructuralDynamics& dynamics = *c.problem.dynamics;
  const StructuralModel& model = dynamics.model();
  const bool over_all = RenewsBasis(c);
  std::vector<ComparedMatrix> all;
  for (const Target target :
       {Target::kMass, Target::kDamping, Target::kStiffness}) {
    // Damping of a reduced model mostly follows from its matrices.
    if (over_all && target == Target::kDamping) continue;
    ComparedMatrix compared;
    compared.target = target;
    if (over_all) {
      const FiniteElementModel& exported = c.finite_element->exported;
      compared.matrix =
          target == Target::kMass ? exported.mass : exported.stiffness;
    } else {
      compared.matrix = (target == Target::kMass      ? model.mass
                         : target == Target::kDamping ? model.damping
                                                      : model.stiffness)
                            .sparseView(0.0, 0.0);
    }
    for (size_t j = 0; j < dynamics.groups().size(); ++j) {
      const MatrixGroup& group = dynamics.groups()[j].group;
      compared.groups.push_back(group.target != target ? SparseMatrix()
                                : over_all ? c.finite_element->groups[j].matrix
                                           : group.matrix.sparseView(0.0, 0.0));
    }
    all.push_back(std::move(compared));
  }
  return all;
}

bool FindOffsets(const std::string& what, const SparseMatrix& own,
                 const StructuralDynamics& dynamics,
                 const ComparedMatrix& compared,
                 const std::vector<std::string>& names, Vector* offsets,
                 std::string* error) {
  const SparseMatrix& expected = compared.matrix;
  const std::string different =
      what +
      ": cannot be the updated matrix of the case's structure, expected a "
      "baseline of the same structure in the same units";
  if (own.rows() != expected.rows() || own.cols() != expected.cols()) {
    *error = different;
    return false;
  }
  std::vector<size_t> used;
  for (size_t j = 0; j < compared.groups.size(); ++j) {
    // The matrix excludes groups that follow time or a covariate.
    if (compared.groups[j].rows() > 0 &&
        dynamics.groups()[j].follows == GroupTerm::Follows::kNothing) {
      used.push_back(j);
    }
  }
  SparseMatrix difference = own - expected;
  const auto count = static_cast<Eigen::Index>(used.size());
  Matrix products(count, count);
  Vector right(count);
  Vector norms(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SparseMatrix& a = compared.groups[used[static_cast<size_t>(i)]];
    norms[i] = a.norm();
    right[i] = a.cwiseProduct(difference).sum() / norms[i];
    for (Eigen::Index j = 0; j <= i; ++j) {
      const SparseMatrix& b = compared.groups[used[static_cast<size_t>(j)]];
      products(i, j) = products(j, i) =
          a.cwiseProduct(b).sum() / (norms[i] * norms[j]);
    }
  }
  Vector shares = Vector::Zero(count);
  if (count > 0) {
    shares = products.completeOrthogonalDecomposition().solve(right);
  }
  shares = shares.cwiseQuotient(norms);
  for (Eigen::Index i = 0; i < count; ++i) {
    const size_t j = used[static_cast<size_t>(i)];
    difference = SparseMatrix(difference - shares[i] * compared.groups[j]);
    const auto name =
        std::find(names.begin(), names.end(), dynamics.groups()[j].group.name);
    if (name != names.end()) (*offsets)[name - names.begin()] = shares[i];
  }
  if (difference.norm() > 1e-7 * std::max(expected.norm(), own.norm())) {
    *error = different;
    return false;
  }
  return true;
}

bool IsAsPresent(const std::string& what, const StructuralDynamics& dynamics,
                 const std::vector<std::string>& names, const Vector& present,
                 const Vector& offsets, std::string* error) {
  const Vector now = AlreadyPresent(dynamics, names);
  for (size_t i = 0; i < names.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double said = present[row] - now[row];
    if (std::abs(offsets[row] - said) <= 1e-6 * (1.0 + std::abs(said))) {
      continue;
    }
    *error = what + ": the matrices of the baseline have " +
             FormatNumber(offsets[row] - said, 3) + " times group '" +
             names[i] +
             "' more than those of the case, without a 'present'. Use a "
             "baseline of the same nominal structure";
    return false;
  }
  return true;
}

bool CompareWithCase(const Case& healthy, const Case& now, Baseline* baseline,
                     std::string* error) {
  const StructuralDynamics& own = *healthy.problem.dynamics;
  const StructuralDynamics& dynamics = *now.problem.dynamics;
  const std::string what = "baseline '" + baseline->name + "'";
  if (RenewsBasis(healthy) != RenewsBasis(now)) {
    *error = what +
             ": only one of baseline and case renews the basis of its "
             "reduction, expected both or neither";
    return false;
  }
  const std::vector<ComparedMatrix> owns = ComparedMatrices(healthy);
  const std::vector<ComparedMatrix> cases = ComparedMatrices(now);
  Vector offsets = Vector::Zero(baseline->groups.values.size());
  for (size_t k = 0; k < cases.size(); ++k) {
    for (size_t j = 0; j < dynamics.groups().size(); ++j) {
      const std::string& name = dynamics.groups()[j].group.name;
      const SparseMatrix& expected = cases[k].groups[j];
      const int group = FindGroup(own, name);
      if (expected.rows() == 0 || group < 0) continue;
      const SparseMatrix& matrix = owns[k].groups[static_cast<size_t>(group)];
      if (matrix.rows() != expected.rows() ||
          (matrix - expected).norm() > 1e-9 * expected.norm()) {
        *error = what + ": its matrix of group '" + name +
                 "' differs from the case's, expected a baseline of the same "
                 "structure in the same units";
        return false;
      }
    }
    if (!FindOffsets(what, owns[k].matrix, dynamics, cases[k],
                     baseline->group_names, &offsets, error)) {
      return false;
    }
  }
  if (!IsAsPresent(what, dynamics, baseline->group_names,
                   AlreadyPresent(own, baseline->group_names), offsets,
                   error)) {
    return false;
  }
  baseline->offsets = std::move(offsets);
  return true;
}

}  // namespace pinode
