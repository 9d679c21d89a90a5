#include "pinode/case/sections/model_section.h"

#include <cmath>
#include <filesystem>
#include <map>

#include "pinode/base/strings.h"
#include "pinode/case/sections/finite_element_section.h"
#include "pinode/structure/matrices/matrix_io.h"
#include "pinode/structure/matrices/matrix_variable.h"
#include "pinode/structure/model/damping.h"

namespace pinode {
namespace {

std::string SizeText(Eigen::Index rows, Eigen::Index cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

bool RowsToMatrix(const TomlTable& table, const std::string& key,
                  const TomlValue& value, Matrix* matrix) {
  const size_t cols =
      value.elements.empty() ? 0 : value.elements[0].elements.size();
  Matrix rows(static_cast<Eigen::Index>(value.elements.size()),
              static_cast<Eigen::Index>(cols));
  for (size_t i = 0; i < value.elements.size(); ++i) {
    const TomlValue& row = value.elements[i];
    if (row.type != TomlValue::Type::kArray || row.elements.size() != cols ||
        cols == 0) {
      return table.errors()->Fail(
          row.line > 0 ? row.line : table.Line(key),
          table.name() + ": row " + std::to_string(i + 1) + " of '" + key +
              "' is " + row.Describe() + " of " +
              std::to_string(row.elements.size()) +
              " entries, expected rows [...] of equal length");
    }
    for (size_t j = 0; j < cols; ++j) {
      const TomlValue& entry = row.elements[j];
      if (!entry.IsNumber() || !std::isfinite(entry.number)) {
        return table.errors()->Fail(
            entry.line > 0 ? entry.line : table.Line(key),
            table.name() + ": entry (" + std::to_string(i + 1) + ", " +
                std::to_string(j + 1) + ") of '" + key + "' is " +
                entry.Describe() + ", expected a finite number");
      }
      rows(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          entry.number;
    }
  }
  *matrix = rows;
  return true;
}

// Reads damping = "none", {rayleigh = ...}, {ratios = ...} or a matrix.
bool ReadDampingRule(const TomlTable& table, int num_dofs, DampingRule* rule) {
  const TomlValue& value = *table.Find("damping");
  if (value.type == TomlValue::Type::kString && value.text == "none") {
    rule->kind = DampingRule::Kind::kNone;
    return true;
  }
  if (!value.IsTable() || value.Find("diagonal") != nullptr ||
      value.Find("file") != nullptr) {
    rule->kind = DampingRule::Kind::kMatrix;
    return ReadMatrixKey(table, "damping", "the damping matrix", num_dofs,
                         &rule->matrix);
  }
  const TomlTable inner = table.Table("damping", table.name() + " damping");
  if (!inner.AllowKeys({"rayleigh", "ratios", "diagonal"})) return false;
  if (inner.Has("rayleigh") == inner.Has("ratios")) {
    return table.Fail("damping",
                      "'damping' expected one of {rayleigh = [a0, a1]}, "
                      "{ratios = [...]}, {diagonal = [...]}, a matrix, or "
                      "\"none\"");
  }
  if (inner.Has("rayleigh")) {
    const std::vector<double> values =
        inner.Numbers("rayleigh", 2, "coefficient: a0 and a1");
    if (!table.errors()->ok()) return false;
    rule->kind = DampingRule::Kind::kRayleigh;
    rule->rayleigh = {values[0], values[1]};
    return true;
  }
  rule->kind = DampingRule::Kind::kRatios;
  rule->ratios = ToVector(inner.Numbers("ratios"));
  for (const double ratio : rule->ratios) {
    // A building with a ratio of 1 does not vibrate.
    if (ratio <= 1.0) continue;
    return inner.Fail("ratios", "a damping ratio of " + FormatNumber(ratio, 6) +
                                    " is " + FormatNumber(100.0 * ratio, 6) +
                                    " % of critical, expected at most 1; 2 % "
                                    "is 0.02");
  }
  return table.errors()->ok();
}

// True with records: modes, measured ones or the model's own, are undamped.
bool NeedsDamping(const TomlTable& root) { return root.Has("record"); }

// Reads the damping of a model without reduction.
bool ReadDamping(const TomlTable& table, StructuralModel* model) {
  DampingRule rule;
  std::string error;
  if (!ReadDampingRule(table, model->num_dofs(), &rule)) return false;
  return DampingBy(rule, model->mass, model->stiffness, &model->damping,
                   &error) ||
         table.Table("damping", table.name() + " damping")
             .Fail("ratios", error);
}

// Makes the model of the coordinates.
bool ReadReducedModel(const TomlTable& table, ReducedStructure* structure,
                      StructuralModel* model) {
  std::string error;
  if (table.Has("damping")) {
    // Damping may be made from the modes of M and K, which must be valid first.
    const ReducedModel& reduced = structure->reduced;
    const StructuralModel undamped =
        MakeStructuralModel(reduced.mass, reduced.damping, reduced.stiffness,
                            reduced.coordinate_names);
    if (!undamped.IsValid(&error)) return table.Fail("finite_element", error);
    DampingRule rule;
    if (!ReadDampingRule(table, undamped.num_dofs(), &rule)) return false;
    structure->damping_rule = std::move(rule);
  }
  return MakeReducedModel(structure, model, &error) ||
         table.Table("damping", table.name() + " damping")
             .Fail("ratios", error);
}

bool ReadShearBuilding(const TomlTable& table, ShearBuilding* building) {
  const TomlTable inner =
      table.Table("shear_building", "[model.shear_building]");
  if (!inner.AllowKeys() || !inner.RequireKey("masses", "one mass per floor") ||
      !inner.RequireKey("stiffnesses", "one stiffness per storey")) {
    return false;
  }
  building->masses = inner.Numbers("masses");
  building->stiffnesses = inner.Numbers("stiffnesses");
  building->dampers = inner.Numbers("dampers");
  building->dof_names = table.Strings("dofs");
  if (!table.errors()->ok()) return false;
  std::string error;
  if (!building->IsValid(&error)) return inner.Fail("masses", error);
  return true;
}

// Reads a matrix with one column per direction from {x = [...], ...}.
bool ReadDirections(const TomlTable& table, const std::string& key,
                    std::vector<std::string>* directions, Matrix* columns) {
  const int n = static_cast<int>(columns->rows());
  const TomlTable inner = table.Table(key, table.name() + " " + key);
  for (const auto& [name, value] : inner.entries()) {
    const std::vector<double> entries = inner.Numbers(name, n, "DOF");
    if (!table.errors()->ok()) return false;
    Eigen::Index column = 0;
    while (column < columns->cols() &&
           (*directions)[static_cast<size_t>(column)] != name) {
      ++column;
    }
    if (column == columns->cols()) {
      directions->push_back(name);
      columns->conservativeResize(n, column + 1);
    }
    columns->col(column) = ToVector(entries);
  }
  return table.errors()->ok();
}

// Returns the key to be corrected if a model is not valid.
std::string KeyOf(const TomlTable& table, const std::string& message) {
  for (const char* key : {"mass", "stiffness", "damping"}) {
    if (message.find(std::string("the ") + key + " matrix") != 0) continue;
    return table.Has(key)                ? key
           : table.Has("finite_element") ? "finite_element"
                                         : "shear_building";
  }
  return table.Has("finite_element") ? "finite_element" : "dofs";
}

bool ReadFiniteElements(const TomlTable& root, const TomlTable& table,
                        const UnitSystem& units, ModelSection* section) {
  if (table.Has("shear_building")) {
    return table.Fail("shear_building",
                      "[model.shear_building] and [model.finite_element] are "
                      "both given, expected one of them");
  }
  if (!ReadFiniteElementSection(root, table, units, &section->finite_element)) {
    return false;
  }
  ReducedStructure& structure = section->finite_element->structure;
  const bool damped = structure.exported.has_damping();
  if (damped && table.Has("damping")) {
    return table.Fail("damping",
                      "'damping' and that of [model.finite_element] are both "
                      "given, expected one of them");
  }
  if (!damped && NeedsDamping(root) &&
      !table.RequireKey("damping",
                        "{rayleigh = [a0, a1]}, {ratios = [...]} or \"none\" "
                        "here, or a matrix in [model.finite_element]")) {
    return false;
  }
  return ReadReducedModel(table, &structure, &section->model);
}

bool ReadBuildingModel(const TomlTable& root, const TomlTable& table,
                       ModelSection* section) {
  for (const char* key : {"mass", "stiffness"}) {
    if (table.Has(key)) {
      return table.Fail(key, std::string("'") + key +
                                 "' and [model.shear_building] are both given, "
                                 "expected one of them");
    }
  }
  ShearBuilding building;
  if (!ReadShearBuilding(table, &building)) return false;
  if (table.Has("damping") && !building.dampers.empty()) {
    return table.Fail("damping",
                      "'damping' and the dampers of [model.shear_building] are "
                      "both given, expected one of them");
  }
  if (NeedsDamping(root) && !table.Has("damping") && building.dampers.empty()) {
    return table.RequireKey(
        "damping", "'damping' or the dampers of [model.shear_building]");
  }
  std::string error;
  if (!BuildShearBuilding(building, &section->model, &error)) {
    return table.Fail("shear_building", error);
  }
  section->building = building;
  return true;
}

bool ReadMatrices(const TomlTable& root, const TomlTable& table,
                  const std::vector<std::string>& dofs,
                  StructuralModel* model) {
  if (dofs.empty()) {
    return table.Fail("dofs",
                      "'dofs' is missing or empty, expected the "
                      "names of the degrees of freedom");
  }
  const int n = static_cast<int>(dofs.size());
  Matrix mass;
  Matrix stiffness;
  if (!table.RequireKey("mass", "a matrix") ||
      !table.RequireKey("stiffness", "a matrix") ||
      (NeedsDamping(root) &&
       !table.RequireKey("damping",
                         "a matrix, {rayleigh = [a0, a1]}, {ratios = [...]} "
                         "or \"none\"")) ||
      !ReadMatrixKey(table, "mass", "the mass matrix", n, &mass) ||
      !ReadMatrixKey(table, "stiffness", "the stiffness matrix", n,
                     &stiffness)) {
    return false;
  }
  *model = MakeStructuralModel(mass, Matrix::Zero(n, n), stiffness, dofs);
  return true;
}

// Reads influence vectors and mass coupling that replace those of the model.
bool ReadInfluence(const TomlTable& table, StructuralModel* model) {
  const int n = model->num_dofs();
  if (table.Has("influence")) {
    model->directions.clear();
    model->influence.resize(n, 0);
    if (!ReadDirections(table, "influence", &model->directions,
                        &model->influence)) {
      return false;
    }
    model->support_mass_coupling = Matrix::Zero(n, model->num_directions());
  }
  const int num_directions = model->num_directions();
  if (table.Has("support_mass_coupling") &&
      !ReadDirections(table, "support_mass_coupling", &model->directions,
                      &model->support_mass_coupling)) {
    return false;
  }
  if (model->num_directions() != num_directions) {
    return table.Fail("support_mass_coupling",
                      "'" + model->directions.back() +
                          "' has no influence vector, expected one of " +
                          Join(std::vector<std::string>(
                                   model->directions.begin(),
                                   model->directions.begin() + num_directions),
                               ", "));
  }
  return true;
}

}  // namespace

std::string ResolvePath(const std::string& case_path, const std::string& name) {
  namespace fs = std::filesystem;
  const fs::path path(name);
  if (path.is_absolute()) return name;
  return (fs::path(case_path).parent_path() / path).string();
}

std::string ResolvePath(const TomlTable& table, const std::string& name) {
  const CaseErrors& errors = *table.errors();
  return errors.data().Has(name) ? name : ResolvePath(errors.path(), name);
}

bool ReadDofNames(const TomlTable& table, std::vector<std::string>* names) {
  *names = table.Strings("dofs");
  if (!table.errors()->ok()) return false;
  for (const std::string& name : *names) {
    // Names appear in x[u1], d[a,b] and "a-b".
    if (name.empty() || name == "ground" ||
        name.find_first_of("[], \t\n\"") != std::string::npos) {
      return table.Fail(
          "dofs", "'" + name +
                      "' cannot be the name of a DOF; expected no brackets, "
                      "commas, blanks or quotes, and not 'ground'");
    }
  }
  return true;
}

bool ReadUnits(const TomlTable& root, UnitSystem* units) {
  const TomlTable table = root.Table("units", "[units]");
  if (!table.AllowKeys()) return false;
  units->force = table.String("force", units->force);
  units->length = table.String("length", units->length);
  units->time = table.String("time", units->time);
  if (!table.errors()->ok()) return false;
  // Keys are checked one at a time, so that the message has the right line.
  for (const char* key : {"force", "length", "time"}) {
    if (!table.Has(key)) continue;
    UnitSystem single;
    const std::string unit = table.String(key);
    (key[0] == 'f'   ? single.force
     : key[0] == 'l' ? single.length
                     : single.time) = unit;
    std::string error;
    if (!single.IsValid(&error)) return table.Fail(key, error);
  }
  return true;
}

namespace {

// Reads a matrix of a file, by its name if the file holds several. *source
// names the place to correct if a size or entry is wrong. `variable` may be
// empty.
bool ReadMatrixFile(const TomlTable& table, const std::string& key,
                    const std::string& file, const std::string& variable,
                    std::string* source, Matrix* matrix) {
  *source = ResolvePath(table, file);
  const std::map<std::string, Matrix>& arrays = table.errors()->data().matrices;
  const auto array = arrays.find(*source);
  if (array != arrays.end()) {
    *matrix = array->second;
    return true;
  }
  if (!std::filesystem::exists(*source)) {
    return table.Fail(key, "'" + key + "' names the file '" + file +
                               "', which does not exist; expected a .csv, "
                               ".mtx, .matrix, .mat, .npz or .op4 file beside "
                               "the case");
  }
  const bool by_name = HoldsMatricesByName(file);
  if (!variable.empty() && !by_name) {
    return table.Fail(key, "'" + file +
                               "' holds a single matrix; leave out 'variable', "
                               "or give a .mat, .npz or .op4 file");
  }
  std::string error;
  if (by_name ? !ReadMatrixVariable(*source, variable, matrix, &error)
              : !ReadMatrix(*source, matrix, &error)) {
    return table.errors()->FailAsIs(error);
  }
  if (!variable.empty()) *source += ": matrix '" + variable + "'";
  return true;
}

// Reads {diagonal = [...]}, or {file = ..., variable = ...}.
bool ReadMatrixTable(const TomlTable& table, const std::string& key,
                     std::string* source, Matrix* matrix) {
  const TomlTable inner = table.Table(key, table.name() + " " + key);
  const bool is_file = inner.Has("file") || inner.Has("variable");
  if (!inner.AllowKeys(is_file ? std::vector<std::string>{"file", "variable"}
                               : std::vector<std::string>{"diagonal"})) {
    return false;
  }
  if (is_file) {
    if (!inner.RequireKey("file", "the file that has the variable")) {
      return false;
    }
    const std::string file = inner.String("file");
    const std::string variable = inner.String("variable");
    return inner.errors()->ok() &&
           ReadMatrixFile(table, key, file, variable, source, matrix);
  }
  if (!inner.RequireKey("diagonal", "the entries of the diagonal")) {
    return false;
  }
  const std::vector<double> diagonal = inner.Numbers("diagonal");
  if (!table.errors()->ok()) return false;
  *matrix = ToVector(diagonal).asDiagonal();
  return true;
}

}  // namespace

bool ReadMatrixKey(const TomlTable& table, const std::string& key,
                   const std::string& what, int num_dofs, Matrix* matrix) {
  const TomlValue& value = *table.Find(key);
  std::string source;
  Matrix result;
  if (value.type == TomlValue::Type::kString) {
    if (!ReadMatrixFile(table, key, value.text, "", &source, &result)) {
      return false;
    }
  } else if (value.IsTable()) {
    if (!ReadMatrixTable(table, key, &source, &result)) return false;
  } else if (value.type == TomlValue::Type::kArray) {
    if (!RowsToMatrix(table, key, value, &result)) return false;
  } else {
    return table.Fail(key, "'" + key + "' is " + value.Describe() +
                               ", expected a file's name, rows [[...], ...], "
                               "{diagonal = [...]} or {file = ..., variable = "
                               "...}");
  }
  std::string message;
  if (result.rows() != num_dofs || result.cols() != num_dofs) {
    message = what + " is " + SizeText(result.rows(), result.cols()) +
              ", expected " + SizeText(num_dofs, num_dofs) +
              ", one row and column per DOF";
  } else if (!result.allFinite()) {
    message = what + " has an entry that is not finite, expected numbers only";
  }
  if (!message.empty()) {
    return source.empty() ? table.Fail(key, message)
                          : table.errors()->FailAsIs(source + ": " + message);
  }
  *matrix = result;
  return true;
}

bool FindDof(const StructuralModel& model, const TomlTable& table,
             const std::string& key, const std::string& name,
             bool ground_allowed, int* index) {
  *index = -1;
  if (ground_allowed && name == "ground") return true;
  *index = model.DofIndex(name);
  if (*index >= 0) return true;
  std::vector<std::string> known = model.dof_names;
  if (ground_allowed) known.push_back("ground");
  return table.Fail(
      key, "'" + name + "' is not a DOF of the model" + NameHint(name, known));
}

bool ReadBetween(const StructuralModel& model, const TomlTable& table,
                 int* from, int* to) {
  const std::vector<std::string> ends = table.Strings("between");
  if (!table.errors()->ok()) return false;
  if (ends.size() != 2 || ends[0] == ends[1]) {
    return table.Fail("between",
                      "'between' expected two different ends, such as "
                      "[\"ground\", \"" +
                          model.dof_names[0] + "\"]");
  }
  return FindDof(model, table, "between", ends[0], true, from) &&
         FindDof(model, table, "between", ends[1], true, to);
}

bool ReadModelSection(const TomlTable& root, const UnitSystem& units,
                      ModelSection* section) {
  CaseErrors* errors = root.errors();
  if (!root.RequireKey("model", "a table [model]")) return false;
  const TomlTable table = root.Table("model", "[model]");
  if (!table.AllowKeys()) {
    return false;
  }
  const bool is_finite_element = table.Has("finite_element");
  if (table.Has("reduction") && !is_finite_element) {
    return table.Fail("reduction",
                      "[model.reduction] needs a [model.finite_element]");
  }
  std::vector<std::string> dofs;
  if (!ReadDofNames(table, &dofs)) return false;
  StructuralModel& model = section->model;
  if (!(is_finite_element ? ReadFiniteElements(root, table, units, section)
        : table.Has("shear_building")
            ? ReadBuildingModel(root, table, section)
            : ReadMatrices(root, table, dofs, &model))) {
    return false;
  }
  // Before the damping, which may be made from the modes of M and K.
  std::string error;
  if (!model.IsValid(&error)) return table.Fail(KeyOf(table, error), error);
  if (table.Has("damping") && !is_finite_element &&
      !ReadDamping(table, &model)) {
    return false;
  }
  if (!ReadInfluence(table, &model)) return false;
  if (!model.IsValid(&error)) return table.Fail(KeyOf(table, error), error);
  if (is_finite_element && table.Has("support_mass_coupling")) {
    section->finite_element->structure.given_support_mass_coupling =
        model.support_mass_coupling;
  }
  section->expected_hz = table.Numbers("expected_hz");
  return errors->ok();
}

}  // namespace pinode
