#include "pinode/case/sections/exported_group.h"

#include <cmath>
#include <filesystem>
#include <system_error>

#include "pinode/base/strings.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/structure/sparse/rigid_body.h"

namespace pinode {
namespace {

// Relative difference of two exports of one number in which only the last
// digits were rounded.
constexpr double kRoundingOfExports = 1e-11;

// Reads the target's matrix of an export that otherwise equals the model's own.
bool ReadOtherExport(const TomlTable& table, const std::string& key,
                     const FiniteElementSection& section,
                     MatrixGroup::Target target, SparseMatrix* matrix,
                     std::string* path) {
  FiniteElementFiles files = section.files;
  MatrixSource* source = target == MatrixGroup::Target::kMass ? &files.mass
                         : target == MatrixGroup::Target::kDamping
                             ? &files.damping
                             : &files.stiffness;
  *source = MatrixSource();
  files.has_set = key == "set_export";
  if (!ReadSource(table, key, source)) return false;
  *path = source->path;
  FiniteElementModel other;
  std::string error;
  if (!ReadFiniteElementModel(files, &other, &error)) {
    return table.errors()->FailAsIs(error);
  }
  if (other.num_dofs() != section.structure.exported.num_dofs()) {
    return table.Fail(
        key, "its DOFs are not those of the model: there are " +
                 std::to_string(other.num_dofs()) + ", expected " +
                 std::to_string(section.structure.exported.num_dofs()));
  }
  for (size_t i = 0; i < other.dof_names.size(); ++i) {
    if (other.dof_names[i] == section.structure.exported.dof_names[i]) continue;
    return table.Fail(key, "its DOFs are not those of the model: row " +
                               std::to_string(i + 1) + " is '" +
                               other.dof_names[i] + "', expected '" +
                               section.structure.exported.dof_names[i] + "'");
  }
  *matrix = target == MatrixGroup::Target::kMass      ? other.mass
            : target == MatrixGroup::Target::kDamping ? other.damping
                                                      : other.stiffness;
  return true;
}

const SparseMatrix& TargetMatrix(const FiniteElementModel& model,
                                 MatrixGroup::Target target) {
  switch (target) {
    case MatrixGroup::Target::kMass:
      return model.mass;
    case MatrixGroup::Target::kDamping:
      return model.damping;
    case MatrixGroup::Target::kStiffness:
      break;
  }
  return model.stiffness;
}

// Returns (changed - whole) / (factor - 1) without the rounding errors of
// unchanged entries.
SparseMatrix SetFromExports(const SparseMatrix& whole,
                            const SparseMatrix& changed, double factor) {
  SparseMatrix difference = changed - whole;
  const SparseMatrix size =
      SparseMatrix(changed.cwiseAbs()) + SparseMatrix(whole.cwiseAbs());
  difference.prune(
      [&size](Eigen::Index row, Eigen::Index column, double value) {
        return std::abs(value) > kRoundingOfExports * size.coeff(row, column);
      });
  difference /= factor - 1.0;
  return difference;
}

}  // namespace

bool ReadSource(const TomlTable& table, const std::string& key,
                MatrixSource* source) {
  const TomlValue* value = table.Find(key);
  if (value == nullptr) return true;
  std::string file;
  if (value->IsTable()) {
    const TomlTable inner = table.Table(key, table.name() + " " + key);
    if (!inner.AllowKeys()) return false;
    file = inner.RequiredString("file");
    source->variable = inner.String("variable");
    source->occurrence = inner.Integer("occurrence", 0, 1, 1000000000);
  } else {
    file = table.RequiredString(key);
  }
  if (!table.errors()->ok()) return false;
  source->path = ResolvePath(table, file);
  const auto& arrays = table.errors()->data().sparse_matrices;
  const auto array = arrays.find(source->path);
  if (array != arrays.end()) {
    source->array = array->second;
    return true;
  }
  std::error_code status;
  if (std::filesystem::exists(source->path, status)) return true;
  return table.Fail(
      key, "'" + key + "' names the file '" + file + "', which does not exist");
}

bool ReadSetMatrix(const TomlTable& table, const FiniteElementSection& section,
                   MatrixGroup::Target target,
                   ReducedStructure::Group* exported) {
  const bool changed = table.Has("changed_export");
  const std::string key = changed ? "changed_export" : "set_export";
  const SparseMatrix& whole = TargetMatrix(section.structure.exported, target);
  if (whole.rows() == 0) {
    return table.Fail(key, "'" + key +
                               "' adds to damping, but [model.finite_element] "
                               "has no 'damping'; add it there");
  }
  double factor = 0.0;
  if (changed) {
    if (!table.RequireKey(
            "factor", "the factor on the property of the set in that export")) {
      return false;
    }
    factor = table.Number("factor", 0.0);
    if (!table.errors()->ok()) return false;
    if (factor == 1.0) {
      return table.Fail("factor",
                        "'factor' is 1, which changes nothing; expected "
                        "another number, such as 1.1");
    }
  }
  SparseMatrix other;
  if (!ReadOtherExport(table, key, section, target, &other,
                       &exported->source)) {
    return false;
  }
  if (changed) other = SetFromExports(whole, other, factor);
  exported->matrix.swap(other);
  exported->is_element_set = true;
  if (exported->matrix.nonZeros() == 0 || exported->matrix.norm() == 0.0) {
    return table.Fail(key, changed ? "the two exports are equal, expected a "
                                     "changed property of the set"
                                   : "the matrix is zero, expected the "
                                     "element set's own");
  }
  // A set is a part of the whole: the remainder must not be negative.
  const Vector part = exported->matrix.diagonal();
  const Vector all = whole.diagonal();
  for (Eigen::Index i = 0; i < part.size(); ++i) {
    if (part[i] <= all[i] + 1e-6 * std::abs(all[i])) continue;
    return table.Fail(
        changed ? "factor" : key,
        "the element set alone has " + FormatNumber(part[i], 4) + " at '" +
            section.structure.exported.dof_names[static_cast<size_t>(i)] +
            "' where the whole model has " + FormatNumber(all[i], 4) +
            ", expected not more" +
            (changed ? "; check the factor of that export" : ""));
  }
  return true;
}

bool ReadExportedGroup(const TomlTable& table,
                       const FiniteElementSection& section, MatrixGroup* group,
                       ReducedStructure::Group* exported) {
  const auto known = section.groups_at_basis.find(table.String("name"));
  if (known != section.groups_at_basis.end()) {
    *exported = known->second;
  } else if (!ReadSetMatrix(table, section, group->target, exported)) {
    return false;
  }
  exported->in_basis = ReducedStructure::Group::InBasis::kReduced;
  const ReducedStructure& structure = section.structure;
  group->matrix = ReduceMatrix(exported->matrix, structure.expansion,
                               structure.reduced.rigid_body_motions);
  return true;
}

}  // namespace pinode
