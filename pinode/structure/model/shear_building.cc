#include "pinode/structure/model/shear_building.h"

#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Returns true if `values` has `size` entries, finite and positive (or zero).
bool IsListValid(const char* what, const std::vector<double>& values, int size,
                 bool zero_allowed, std::string* error) {
  if (static_cast<int>(values.size()) != size) {
    *error = "shear building: " + std::to_string(values.size()) + " " + what +
             ", expected " + std::to_string(size) +
             ", one a storey as for the masses";
    return false;
  }
  for (size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) &&
        (values[i] > 0.0 || (zero_allowed && values[i] == 0.0))) {
      continue;
    }
    *error = "shear building: entry " + std::to_string(i + 1) + " of the " +
             what + " is " + FormatNumber(values[i], 6) + ", expected a " +
             (zero_allowed ? "number of zero or more" : "positive number");
    return false;
  }
  return true;
}

// Stiffness matrix of a unit spring in a storey, from 1.
Matrix UnitStorey(int num_storeys, int storey) {
  return SpringMatrix(num_storeys, storey - 2, storey - 1);
}

}  // namespace

bool ShearBuilding::IsValid(std::string* error) const {
  CHECK(error != nullptr);
  const int n = num_storeys();
  if (n == 0) {
    *error = "shear building: no masses, expected one a floor";
    return false;
  }
  if (!IsListValid("masses", masses, n, false, error) ||
      !IsListValid("stiffnesses", stiffnesses, n, false, error)) {
    return false;
  }
  if (!dampers.empty() && !IsListValid("dampers", dampers, n, true, error)) {
    return false;
  }
  if (!dof_names.empty() && static_cast<int>(dof_names.size()) != n) {
    *error = "shear building: " + std::to_string(dof_names.size()) +
             " DOF names, expected " + std::to_string(n) + ", one a floor";
    return false;
  }
  return true;
}

bool BuildShearBuilding(const ShearBuilding& building, StructuralModel* model,
                        std::string* error) {
  CHECK(model != nullptr);
  CHECK(error != nullptr);
  if (!building.IsValid(error)) return false;
  const int n = building.num_storeys();
  Matrix mass = Matrix::Zero(n, n);
  Matrix damping = Matrix::Zero(n, n);
  Matrix stiffness = Matrix::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    const Matrix storey = UnitStorey(n, i + 1);
    mass(i, i) = building.masses[i];
    stiffness += building.stiffnesses[i] * storey;
    if (!building.dampers.empty()) damping += building.dampers[i] * storey;
  }
  StructuralModel built =
      MakeStructuralModel(mass, damping, stiffness, building.dof_names);
  if (!built.IsValid(error)) return false;
  *model = std::move(built);
  return true;
}

bool StoreyGroup(const ShearBuilding& building, MatrixGroup::Target target,
                 int storey, MatrixGroup* group, std::string* error) {
  CHECK(group != nullptr);
  CHECK(error != nullptr);
  if (!building.IsValid(error)) return false;
  const int n = building.num_storeys();
  if (storey < 1 || storey > n) {
    *error = "shear building: there is no storey " + std::to_string(storey) +
             ", expected 1 (the lowest) to " + std::to_string(n);
    return false;
  }
  const size_t i = static_cast<size_t>(storey) - 1;
  MatrixGroup result;
  result.target = target;
  switch (target) {
    case MatrixGroup::Target::kMass:
      result.name = "m";
      result.matrix = Matrix::Zero(n, n);
      result.matrix(storey - 1, storey - 1) = building.masses[i];
      break;
    case MatrixGroup::Target::kDamping:
      if (building.dampers.empty() || building.dampers[i] == 0.0) {
        *error = "shear building: storey " + std::to_string(storey) +
                 " has no damper for a group of its damping. Give it a damper, "
                 "or a group between its floors";
        return false;
      }
      result.name = "c";
      result.matrix = building.dampers[i] * UnitStorey(n, storey);
      break;
    case MatrixGroup::Target::kStiffness:
      result.name = "k";
      result.matrix = building.stiffnesses[i] * UnitStorey(n, storey);
      break;
  }
  result.name += std::to_string(storey);
  *group = std::move(result);
  return true;
}

bool StoreyGroups(const ShearBuilding& building, MatrixGroup::Target target,
                  std::vector<MatrixGroup>* groups, std::string* error) {
  CHECK(groups != nullptr);
  CHECK(error != nullptr);
  if (!building.IsValid(error)) return false;
  std::vector<MatrixGroup> result(building.masses.size());
  for (int storey = 1; storey <= building.num_storeys(); ++storey) {
    if (!StoreyGroup(building, target, storey, &result[storey - 1], error)) {
      return false;
    }
  }
  *groups = std::move(result);
  return true;
}

}  // namespace pinode
