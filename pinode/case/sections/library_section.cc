#include "pinode/case/sections/library_section.h"

#include <memory>
#include <set>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/case/sections/feature_text.h"
#include "pinode/case/text/parameter_keys.h"
#include "pinode/dynamics/library_law.h"
#include "pinode/study/terms/library_term.h"

namespace pinode {
namespace {

// Reads one entry of `terms`: the basis alone, or a table.
bool ReadTerm(const TomlTable& table, const TomlValue& value,
              const std::vector<std::string>& feature_names,
              const LawTerm& term, const std::vector<InputSpec>& inputs,
              const UnitSystem& units, LibraryFunction* function,
              Parameter* parameter) {
  const std::string expected =
      "expected a function such as \"x[u1]^3\", or a table {basis = \"...\", "
      "initial = ...}";
  std::string text;
  if (value.type == TomlValue::Type::kString) {
    text = value.text;
  } else if (value.IsTable()) {
    const TomlValue* basis = value.Find("basis");
    if (basis == nullptr || basis->type != TomlValue::Type::kString) {
      return table.Fail("terms",
                        "a term of 'terms' has no 'basis', " + expected);
    }
    text = basis->text;
  } else {
    return table.Fail("terms",
                      "'terms' holds " + value.Describe() + ", " + expected);
  }
  std::string error;
  if (!LibraryFunction::Parse(text, feature_names, function, &error)) {
    return table.Fail(
        "terms", error + " (of the inputs " + Join(feature_names, ", ") + ")");
  }
  parameter->name = term.name + "." + function->text();
  parameter->unit = LibraryCoefficientUnit(*function, term.features, inputs,
                                           term.acts_as, units);
  if (!value.IsTable()) return true;
  const TomlTable keys(value, table.name() + ", term '" + text + "'",
                       table.errors(), "library.terms");
  return keys.AllowKeys() && ReadParameterKeys(keys, 1.0, parameter);
}

// Reads `inputs`, the features of *term; *names as the functions write them.
bool ReadLibraryInputs(const TomlTable& table,
                       const StructuralDynamics& dynamics, LawTerm* term,
                       std::vector<std::string>* names) {
  const std::vector<std::string> inputs = table.Strings("inputs");
  if (!table.errors()->ok()) return false;
  if (inputs.empty()) {
    return table.Fail("inputs",
                      "'inputs' is missing or empty, expected at least one");
  }
  if (static_cast<int>(inputs.size()) > LibraryLaw::kMaxFeatures) {
    return table.Fail("inputs", std::to_string(inputs.size()) +
                                    " inputs, expected at most " +
                                    std::to_string(LibraryLaw::kMaxFeatures));
  }
  std::set<std::string> seen;
  for (const std::string& text : inputs) {
    Feature feature;
    if (!ParseFeature(table, "inputs", dynamics, text, &feature)) return false;
    term->features.push_back(feature);
    names->push_back(
        feature.Name(dynamics.model().dof_names, InputNames(dynamics)));
    if (!seen.insert(names->back()).second) {
      return table.Fail("inputs", "'" + text + "' is given twice");
    }
  }
  return true;
}

// Reads `terms`, the law and the parameters of *term, whose inputs are known.
bool ReadLibraryFunctions(const TomlTable& table, const TermsContext& context,
                          const StructuralDynamics& dynamics,
                          const std::vector<std::string>& names,
                          LawTerm* term) {
  const TomlValue* terms = table.Find("terms");
  if (terms == nullptr || terms->type != TomlValue::Type::kArray ||
      terms->elements.empty()) {
    return table.Fail("terms",
                      "'terms' is missing or empty, expected terms = "
                      "[\"x[" +
                          dynamics.model().dof_names[0] + "]^3\", ...]");
  }
  std::vector<LibraryFunction> functions;
  std::set<std::string> seen;
  for (const TomlValue& value : terms->elements) {
    LibraryFunction function;
    Parameter parameter;
    if (!ReadTerm(table, value, names, *term, dynamics.inputs(), *context.units,
                  &function, &parameter)) {
      return false;
    }
    if (!seen.insert(function.text()).second) {
      return table.Fail("terms",
                        "the term '" + function.text() + "' is given twice");
    }
    functions.push_back(std::move(function));
    term->parameters.parameters.push_back(std::move(parameter));
  }
  term->law = std::make_shared<LibraryLaw>(
      static_cast<int>(term->features.size()), std::move(functions));
  return true;
}

// Reads `select`: all free terms become candidates.
bool AddLibraryCandidates(const TomlTable& table, const LawTerm& term,
                          const TermsContext& context) {
  bool any = false;
  for (int k = 0; k < term.parameters.size(); ++k) {
    if (!term.parameters.parameters[static_cast<size_t>(k)].free) continue;
    context.candidates->push_back(LibraryCandidate(term, k));
    any = true;
  }
  return any || table.Fail("select",
                           "none of its terms is free, expected at least one "
                           "that may be left out");
}

}  // namespace

bool ReadLibraries(const TomlTable& root, const TermsContext& context,
                   StructuralDynamics* dynamics) {
  std::set<std::string> seen;
  for (const LawTerm& law : dynamics->laws()) seen.insert(law.name);
  for (TomlTable& table : root.Tables("library")) {
    if (!table.AllowKeys()) {
      return false;
    }
    LawTerm term;
    term.type = "library";
    term.name = table.RequiredString("name");
    if (!root.errors()->ok()) return false;
    table.set_name("library '" + term.name + "'");
    if (!CheckName(table, "name", term.name)) return false;
    if (!seen.insert(term.name).second) {
      return table.Fail("name",
                        "this name is used twice, expected different names");
    }
    term.parameters.name = term.name;
    const std::string output = table.RequiredString("output");
    term.acts_as = table.Choice("acts_as", {"acceleration", "force"},
                                "acceleration") == "force"
                       ? ActsAs::kForce
                       : ActsAs::kAcceleration;
    std::vector<std::string> names;
    Vector column;
    if (!ReadLibraryInputs(table, *dynamics, &term, &names) ||
        !ParseOutput(table, "output", context.model->model, output, &column)) {
      return false;
    }
    term.outputs = column;
    std::string error;
    if (!ReadLibraryFunctions(table, context, *dynamics, names, &term))
      return false;
    if (table.Boolean("select", false) &&
        !AddLibraryCandidates(table, term, context)) {
      return false;
    }
    if (!dynamics->AddLaw(std::move(term), &error)) {
      return table.Fail("name", error);
    }
  }
  return root.errors()->ok();
}

}  // namespace pinode
