#include "pinode/structure/model/structural_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/model/symmetric.h"

namespace pinode {
namespace {

int IndexOf(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

std::string SizeText(Eigen::Index rows, Eigen::Index columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

// Returns "('u1', 'u2')": an entry by the names of its row and column.
std::string EntryText(const std::vector<std::string>& row_names,
                      const std::vector<std::string>& column_names, int row,
                      int column) {
  return "('" + row_names[row] + "', '" + column_names[column] + "')";
}

bool AreNamesValid(const std::vector<std::string>& names, const char* kind,
                   std::string* error) {
  std::set<std::string> seen;
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) {
      *error = std::string(kind) + " " + std::to_string(i + 1) +
               " has an empty name; give it one";
      return false;
    }
    if (!seen.insert(names[i]).second) {
      *error = std::string("the name '") + names[i] + "' is used by " + kind +
               " " + std::to_string(IndexOf(names, names[i]) + 1) + " and " +
               kind + " " + std::to_string(i + 1) + "; names must be unique";
      return false;
    }
  }
  return true;
}

bool HasSizeAndFiniteEntries(const std::string& what, const Matrix& matrix,
                             const std::vector<std::string>& row_names,
                             const std::vector<std::string>& column_names,
                             const char* columns_are, std::string* error) {
  const int rows = static_cast<int>(row_names.size());
  const int columns = static_cast<int>(column_names.size());
  if (matrix.rows() != rows || matrix.cols() != columns) {
    *error = what + " is " + SizeText(matrix.rows(), matrix.cols()) +
             ", expected " + SizeText(rows, columns) +
             ": one row per DOF, one column per " + columns_are;
    return false;
  }
  for (int j = 0; j < columns; ++j) {
    for (int i = 0; i < rows; ++i) {
      if (std::isfinite(matrix(i, j))) continue;
      *error = what + ": entry " + EntryText(row_names, column_names, i, j) +
               " is " + FormatNumber(matrix(i, j), 6) +
               ", expected a finite number";
      return false;
    }
  }
  return true;
}

bool IsSymmetricMatrix(const std::string& what, const Matrix& matrix,
                       const std::vector<std::string>& dof_names,
                       std::string* error) {
  if (!HasSizeAndFiniteEntries(what, matrix, dof_names, dof_names, "DOF",
                               error)) {
    return false;
  }
  const Asymmetry worst = LargestAsymmetry(matrix);
  if (worst.relative <= kSymmetryTolerance) return true;
  *error = what + " is not symmetric: " +
           EntryText(dof_names, dof_names, worst.row, worst.column) + " = " +
           FormatNumber(matrix(worst.row, worst.column), 6) + " but " +
           EntryText(dof_names, dof_names, worst.column, worst.row) + " = " +
           FormatNumber(matrix(worst.column, worst.row), 6) +
           " (relative difference " + FormatNumber(worst.relative, 6) +
           ", at most " + FormatNumber(kSymmetryTolerance, 6) +
           " is accepted); check both entries";
  return false;
}

// Checks a symmetric `mass`. The test uses M scaled to a unit diagonal, so that
// it does not depend on units, also for rotations and translations together.
bool IsPositiveDefiniteMass(const Matrix& mass,
                            const std::vector<std::string>& dof_names,
                            std::string* error) {
  const int n = static_cast<int>(mass.rows());
  for (int i = 0; i < n; ++i) {
    if (mass(i, i) > 0.0) continue;
    *error = "the mass matrix is not positive definite: DOF '" + dof_names[i] +
             "' has the mass " + FormatNumber(mass(i, i), 6) +
             "; give it mass, or condense it out of all matrices";
    return false;
  }
  const Vector scale = mass.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix scaled =
      scale.asDiagonal() * SymmetricPart(mass) * scale.asDiagonal();
  const double floor = n * std::numeric_limits<double>::epsilon();
  const Eigen::LLT<Matrix> cholesky(scaled);
  // A squared pivot is at least the smallest eigenvalue. If a pivot fails, the
  // eigenvalues show by how much.
  if (cholesky.info() == Eigen::Success &&
      cholesky.matrixLLT().diagonal().cwiseAbs2().minCoeff() > floor) {
    return true;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scaled);
  int dof = 0;
  eigen.eigenvectors().col(0).cwiseAbs().maxCoeff(&dof);
  *error =
      "the mass matrix is not positive definite. Scaled to a unit diagonal its "
      "smallest eigenvalue is " +
      FormatNumber(eigen.eigenvalues()[0], 6) + ", most of it at DOF '" +
      dof_names[dof] +
      "'. Check the entries that couple this DOF, or condense it out of all "
      "matrices";
  return false;
}

Matrix* MutableTarget(StructuralModel* model, MatrixGroup::Target target) {
  switch (target) {
    case MatrixGroup::Target::kMass:
      return &model->mass;
    case MatrixGroup::Target::kDamping:
      return &model->damping;
    case MatrixGroup::Target::kStiffness:
      return &model->stiffness;
  }
  LOG(FATAL) << "unknown target " << static_cast<int>(target);
  return nullptr;
}

}  // namespace

int StructuralModel::DofIndex(const std::string& name) const {
  return IndexOf(dof_names, name);
}

int StructuralModel::DirectionIndex(const std::string& name) const {
  return IndexOf(directions, name);
}

bool StructuralModel::IsValid(std::string* error) const {
  CHECK(error != nullptr);
  if (dof_names.empty()) {
    *error = "the model has no DOFs; name at least one";
    return false;
  }
  return AreNamesValid(dof_names, "DOF", error) &&
         AreNamesValid(directions, "direction", error) &&
         IsSymmetricMatrix("the mass matrix", mass, dof_names, error) &&
         IsSymmetricMatrix("the damping matrix", damping, dof_names, error) &&
         IsSymmetricMatrix("the stiffness matrix", stiffness, dof_names,
                           error) &&
         IsPositiveDefiniteMass(mass, dof_names, error) &&
         HasSizeAndFiniteEntries("the influence matrix", influence, dof_names,
                                 directions, "direction", error) &&
         HasSizeAndFiniteEntries("the support mass coupling",
                                 support_mass_coupling, dof_names, directions,
                                 "direction", error);
}

StructuralModel MakeStructuralModel(const Matrix& mass, const Matrix& damping,
                                    const Matrix& stiffness,
                                    std::vector<std::string> dof_names) {
  const int n = static_cast<int>(mass.rows());
  if (dof_names.empty()) {
    for (int i = 1; i <= n; ++i) dof_names.push_back("u" + std::to_string(i));
  }
  StructuralModel model;
  model.dof_names = std::move(dof_names);
  model.mass = mass;
  model.damping = damping;
  model.stiffness = stiffness;
  model.directions = {"x"};
  model.influence = Matrix::Ones(model.num_dofs(), 1);
  model.support_mass_coupling = Matrix::Zero(model.num_dofs(), 1);
  return model;
}

bool MatrixGroup::IsValid(const std::vector<std::string>& dof_names,
                          std::string* error) const {
  CHECK(error != nullptr);
  if (name.empty()) {
    *error = "a group has an empty name; give it one";
    return false;
  }
  const std::string what = "the matrix of group '" + name + "'";
  if (!IsSymmetricMatrix(what, matrix, dof_names, error)) return false;
  if (matrix.isZero(0.0)) {
    *error = what + " is zero: no value of the unknown would change the " +
             TargetName(target) + "; give it at least one entry";
    return false;
  }
  return true;
}

const char* TargetName(MatrixGroup::Target target) {
  switch (target) {
    case MatrixGroup::Target::kMass:
      return "mass";
    case MatrixGroup::Target::kDamping:
      return "damping";
    case MatrixGroup::Target::kStiffness:
      return "stiffness";
  }
  LOG(FATAL) << "unknown target " << static_cast<int>(target);
  return nullptr;
}

bool ParseTarget(const std::string& name, MatrixGroup::Target* target) {
  CHECK(target != nullptr);
  for (const auto candidate :
       {MatrixGroup::Target::kMass, MatrixGroup::Target::kDamping,
        MatrixGroup::Target::kStiffness}) {
    if (name == TargetName(candidate)) {
      *target = candidate;
      return true;
    }
  }
  return false;
}

bool AreGroupsValid(const StructuralModel& model,
                    const std::vector<MatrixGroup>& groups,
                    std::string* error) {
  CHECK(error != nullptr);
  std::vector<std::string> names;
  for (const MatrixGroup& group : groups) {
    if (!group.IsValid(model.dof_names, error)) return false;
    names.push_back(group.name);
  }
  return AreNamesValid(names, "group", error);
}

StructuralModel ApplyGroups(const StructuralModel& model,
                            const std::vector<MatrixGroup>& groups,
                            const Vector& alphas) {
  CHECK_EQ(alphas.size(), static_cast<Eigen::Index>(groups.size()))
      << "give one alpha per group";
  StructuralModel result = model;
  for (size_t j = 0; j < groups.size(); ++j) {
    Matrix* target = MutableTarget(&result, groups[j].target);
    CHECK(target->rows() == groups[j].matrix.rows() &&
          target->cols() == groups[j].matrix.cols())
        << "group '" << groups[j].name << "' does not have the model's size";
    *target += alphas[static_cast<Eigen::Index>(j)] * groups[j].matrix;
  }
  return result;
}

Matrix SpringMatrix(int num_dofs, int dof_a, int dof_b) {
  CHECK(dof_a >= -1 && dof_a < num_dofs && dof_b >= -1 && dof_b < num_dofs)
      << "a spring from DOF " << dof_a << " to DOF " << dof_b
      << " in a model of " << num_dofs << " DOFs; -1 is the ground";
  CHECK_NE(dof_a, dof_b) << "a spring needs two different ends";
  Matrix matrix = Matrix::Zero(num_dofs, num_dofs);
  if (dof_a >= 0) matrix(dof_a, dof_a) = 1.0;
  if (dof_b >= 0) matrix(dof_b, dof_b) = 1.0;
  if (dof_a >= 0 && dof_b >= 0) {
    matrix(dof_a, dof_b) = -1.0;
    matrix(dof_b, dof_a) = -1.0;
  }
  return matrix;
}

}  // namespace pinode
