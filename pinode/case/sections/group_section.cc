#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/sections/exported_group.h"
#include "pinode/case/sections/finite_element_section.h"
#include "pinode/case/sections/terms_section.h"
#include "pinode/case/text/parameter_keys.h"
#include "pinode/structure/model/damping.h"
#include "pinode/structure/model/shear_building.h"

namespace pinode {
namespace {

constexpr char kTargets[] = "stiffness, damping, mass";

// Reads a part of Rayleigh's damping: the model's own mass or stiffness,
// scaled.
bool ReadProportional(const TomlTable& table, const ModelSection& section,
                      MatrixGroup* group, ReducedStructure::Group* exported) {
  const std::string of =
      table.Choice("proportional_to", {"mass", "stiffness"}, "mass");
  const double scale = table.PositiveNumber("scale", 1.0);
  if (!table.errors()->ok()) return false;
  const bool of_mass = of == "mass";
  if (group->target != MatrixGroup::Target::kDamping) {
    return table.Fail("proportional_to",
                      "'proportional_to' needs adds_to = \"damping\"");
  }
  if (section.finite_element == nullptr) {
    group->matrix =
        scale * (of_mass ? section.model.mass : section.model.stiffness);
    return true;
  }
  using InBasis = ReducedStructure::Group::InBasis;
  exported->in_basis = of_mass ? InBasis::kOfMass : InBasis::kOfStiffness;
  exported->scale = scale;
  std::string error;
  return GroupInBasis(section.finite_element->structure, exported,
                      &group->matrix, &error) ||
         table.Fail("proportional_to", error);
}

// Reads the damping of one mode, or of all modes from one on.
bool ReadModes(const TomlTable& table, const ModelSection& section,
               MatrixGroup* group, ReducedStructure::Group* exported) {
  const bool one = table.Has("mode");
  const char* key = one ? "mode" : "modes_from";
  if (group->target != MatrixGroup::Target::kDamping) {
    return table.Fail(key,
                      std::string("'") + key + "' needs adds_to = \"damping\"");
  }
  if (!table.RequireKey(
          "ratio", "the damping ratio that alpha = 1 adds, such as 0.02")) {
    return false;
  }
  const int n = section.model.num_dofs();
  const int first = table.Integer(key, 1, 1, n);
  const double ratio = table.PositiveNumber("ratio", 0.02);
  if (!table.errors()->ok()) return false;
  exported->in_basis = ReducedStructure::Group::InBasis::kOfModes;
  exported->scale = ratio;
  exported->first_mode = first;
  exported->last_mode = one ? first : 0;
  const StructuralModel& model = section.model;
  std::string error;
  const bool done =
      section.finite_element != nullptr
          ? GroupInBasis(section.finite_element->structure, exported,
                         &group->matrix, &error)
          : DampingOfModes(model.mass, model.stiffness, first,
                           exported->last_mode, ratio, &group->matrix, &error);
  return done || table.Fail(key, error);
}

// Reads the matrix; *exported is the group over all DOFs of a finite-element
// model.
bool ReadGroupMatrix(const TomlTable& table, const ModelSection& section,
                     MatrixGroup* group, ReducedStructure::Group* exported) {
  const StructuralModel& model = section.model;
  const bool from_export =
      table.Has("changed_export") || table.Has("set_export");
  const bool of_modes = table.Has("mode") || table.Has("modes_from");
  const int count = table.Has("between") + table.Has("matrix") +
                    table.Has("storey") + table.Has("proportional_to") +
                    table.Has("mode") + table.Has("modes_from") +
                    table.Has("changed_export") + table.Has("set_export");
  if (count != 1) {
    return table.Fail("name", "it has " + std::to_string(count) +
                                  " of the keys between, matrix, storey, "
                                  "proportional_to, mode, modes_from, "
                                  "changed_export, set_export; expected "
                                  "exactly one");
  }
  if (table.Has("ratio") && !of_modes) {
    return table.Fail("ratio", "'ratio' needs 'mode' or 'modes_from'");
  }
  if (table.Has("factor") && !table.Has("changed_export")) {
    return table.Fail("factor", "'factor' needs 'changed_export'");
  }
  if (from_export && section.finite_element == nullptr) {
    return table.Fail(table.Has("set_export") ? "set_export" : "changed_export",
                      "an export needs a [model.finite_element]; otherwise "
                      "give 'between' or 'matrix'");
  }
  if (table.Has("scale") && !table.Has("between") &&
      !table.Has("proportional_to")) {
    return table.Fail("scale", "'scale' needs 'between' or 'proportional_to'");
  }
  if (from_export) {
    return ReadExportedGroup(table, *section.finite_element, group, exported);
  }
  if (of_modes) return ReadModes(table, section, group, exported);
  if (table.Has("proportional_to")) {
    return ReadProportional(table, section, group, exported);
  }
  if (table.Has("between")) {
    int from = -1;
    int to = -1;
    if (!ReadBetween(model, table, &from, &to)) return false;
    const double scale = table.PositiveNumber("scale", 1.0);
    group->matrix = scale * SpringMatrix(model.num_dofs(), from, to);
    if (section.finite_element != nullptr) {
      *exported =
          SpringGroup(section.finite_element->structure, scale, from, to);
    }
    return table.errors()->ok();
  }
  if (table.Has("matrix")) {
    return ReadMatrixKey(table, "matrix",
                         "the matrix of group '" + group->name + "'",
                         model.num_dofs(), &group->matrix);
  }
  const int storey = table.Integer("storey", 1, 1, 1000000000);
  if (!table.errors()->ok()) return false;
  if (!section.building.has_value()) {
    return table.Fail("storey",
                      "'storey' needs a [model.shear_building]; otherwise give "
                      "'between' or 'matrix'");
  }
  MatrixGroup of_storey;
  std::string error;
  if (!StoreyGroup(*section.building, group->target, storey, &of_storey,
                   &error)) {
    return table.Fail("storey", error);
  }
  group->matrix = of_storey.matrix;
  return true;
}

// Reads the knots, and the index of the reference.
bool ReadKnots(const TomlTable& follows, GroupCurve* curve) {
  curve->knots = follows.Numbers("knots");
  if (!follows.errors()->ok()) return false;
  const std::vector<double>& knots = curve->knots;
  if (knots.size() < 2 ||
      std::adjacent_find(knots.begin(), knots.end(),
                         std::greater_equal<double>()) != knots.end()) {
    return follows.Fail("knots",
                        "'knots' expected two values of the covariate or more, "
                        "ascending");
  }
  if (!follows.RequireKey("reference",
                          "the knot at which the group has its own value")) {
    return false;
  }
  const double reference = follows.Number("reference", 0.0);
  if (!follows.errors()->ok()) return false;
  const auto at = std::find(knots.begin(), knots.end(), reference);
  if (at == knots.end()) {
    return follows.Fail("reference", "'reference' is " +
                                         FormatNumber(reference, 6) +
                                         ", expected one of the knots");
  }
  curve->reference = static_cast<int>(at - knots.begin());
  return true;
}

bool ReadCurvePrior(const TomlTable& follows, GroupCurve* curve) {
  const int differences = follows.Integer("differences", 1, 1, 1000000000);
  if (!follows.errors()->ok()) return false;
  if (differences > 2 || differences >= static_cast<int>(curve->knots.size())) {
    return follows.Fail("differences",
                        "'differences' is " + std::to_string(differences) +
                            " of " + std::to_string(curve->knots.size()) +
                            " knots, expected 1, or 2 of three knots or more");
  }
  double sigma = 0.0;
  const TomlValue* smoothness = follows.Find("smoothness");
  if (smoothness != nullptr && smoothness->type == TomlValue::Type::kString) {
    if (smoothness->text != "evidence") {
      return follows.Fail("smoothness",
                          "'smoothness' is '" + smoothness->text +
                              "', expected \"evidence\" or a number, the usual "
                              "change of alpha from knot to knot");
    }
  } else if (smoothness != nullptr) {
    sigma = follows.PositiveNumber("smoothness", 1.0);
  }
  curve->prior = CurvePrior(curve->knots, curve->reference, differences, sigma);
  return follows.errors()->ok();
}

// Reads the changes of alpha from knot to knot, in addition to its value at the
// reference.
bool ReadCurve(const TomlTable& follows, const std::string& covariate,
               const GroupTerm& term, GroupCurve* curve) {
  curve->name = term.group.name;
  curve->group = term.group;
  curve->input = term.input;
  if (!ReadKnots(follows, curve) || !ReadCurvePrior(follows, curve)) {
    return false;
  }
  const int num_knots = static_cast<int>(curve->knots.size());
  std::vector<double> values(curve->knots.size(), 0.0);
  if (follows.Has("values")) {
    values = follows.Numbers("values", num_knots, "one for each knot");
    if (!follows.errors()->ok()) return false;
    if (values[static_cast<size_t>(curve->reference)] != 0.0) {
      return follows.Fail(
          "values", "'values' are relative to the reference, expected 0 there");
    }
  }
  const bool free = follows.Boolean("free", true);
  curve->parameters.name = curve->name + "." + covariate;
  for (int k = 0; k < num_knots; ++k) {
    if (k == curve->reference) continue;
    Parameter parameter;
    parameter.name =
        KnotName(curve->name, covariate, curve->knots[static_cast<size_t>(k)]);
    parameter.value = values[static_cast<size_t>(k)];
    parameter.free = free;
    curve->parameters.parameters.push_back(parameter);
  }
  return follows.errors()->ok();
}

// Reads `follows`. *curve has no knots if the group follows no covariate or a
// straight line.
bool ReadFollows(const TomlTable& table, const UnitSystem& units,
                 const StructuralDynamics& dynamics, GroupTerm* term,
                 GroupCurve* curve) {
  if (!table.Has("follows")) return true;
  const TomlTable follows = table.Table("follows", table.name() + " follows");
  if (!follows.AllowKeys()) {
    return false;
  }
  for (const char* key : {"smoothness", "differences", "values", "free"}) {
    if (follows.Has(key) && !follows.Has("knots")) {
      return follows.Fail(key, std::string("'") + key + "' needs 'knots'");
    }
  }
  if (follows.Has("knots") && follows.Has("time")) {
    return follows.Fail("knots", "'knots' need a covariate, not time");
  }
  if (follows.Has("covariate") == follows.Has("time")) {
    return table.Fail("follows",
                      "'follows' expected {covariate = \"...\", reference = "
                      "...} or {time = \"linear\", reference = ...}");
  }
  term->reference = follows.Number("reference", 0.0);
  if (follows.Has("time")) {
    follows.Choice("time", {"linear"}, "linear");
    term->follows = GroupTerm::Follows::kTime;
    double seconds = 1.0;
    std::string error;
    if (!UnitFactor("s", Dimension::kTime, units, &seconds, &error)) {
      return follows.Fail("reference", error);
    }
    term->reference *= seconds;
    return table.errors()->ok();
  }
  const std::string name = follows.String("covariate");
  std::vector<std::string> known;
  for (int i = 0; i < dynamics.num_inputs(); ++i) {
    const InputSpec& input = dynamics.inputs()[static_cast<size_t>(i)];
    if (input.kind != InputSpec::Kind::kCovariate) continue;
    known.push_back(input.name);
    if (input.name == name) term->input = i;
  }
  if (term->input < 0) {
    return follows.Fail("covariate", "no record has a covariate '" + name +
                                         "'" + NameHint(name, known));
  }
  // With knots alpha is the value at the reference, and the changes form a
  // separate term.
  if (follows.Has("knots")) return ReadCurve(follows, name, *term, curve);
  term->follows = GroupTerm::Follows::kCovariate;
  return table.errors()->ok();
}

}  // namespace

bool ReadGroups(const TomlTable& root, const TermsContext& context,
                StructuralDynamics* dynamics) {
  for (TomlTable& table : root.Tables("group")) {
    if (!table.AllowKeys()) return false;
    GroupTerm term;
    term.group.name = table.RequiredString("name");
    if (!root.errors()->ok()) return false;
    table.set_name("group '" + term.group.name + "'");
    if (!CheckName(table, "name", term.group.name) ||
        !table.RequireKey("adds_to", std::string("one of ") + kTargets)) {
      return false;
    }
    const std::string target = table.String("adds_to");
    if (!root.errors()->ok()) return false;
    if (!ParseTarget(target, &term.group.target)) {
      return table.Fail("adds_to", "'adds_to' is '" + target +
                                       "', expected one of " + kTargets);
    }
    ReducedStructure::Group exported;
    GroupCurve curve;
    if (!ReadGroupMatrix(table, *context.model, &term.group, &exported) ||
        !ReadFollows(table, *context.units, *dynamics, &term, &curve)) {
      return false;
    }
    term.present = table.Number("present", 1.0);
    term.alpha.name = term.group.name;
    if (!ReadParameterKeys(table, 1.0, &term.alpha)) return false;
    std::string error;
    if (!dynamics->AddGroup(term, &error)) return table.Fail("name", error);
    if (!curve.knots.empty() &&
        !dynamics->AddGroupCurve(std::move(curve), &error)) {
      return table.Fail("follows", error);
    }
    if (context.model->finite_element != nullptr) {
      // Damping ratios are not written as a matrix: neither those of groups nor
      // those of the model.
      const ReducedStructure& structure =
          context.model->finite_element->structure;
      const bool is_ratio =
          exported.in_basis == ReducedStructure::Group::InBasis::kOfModes &&
          structure.damping.rows() == 0;
      if (exported.matrix.rows() == 0 && !is_ratio) {
        context.remarks->push_back(
            "Group '" + term.group.name +
            "' belongs to the coordinates of the reduced model. The written "
            "matrices of the finite-element model do not include it.");
      }
      context.model->finite_element->structure.groups.push_back(
          std::move(exported));
    }
  }
  return root.errors()->ok();
}

}  // namespace pinode
