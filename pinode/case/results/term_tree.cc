#include "pinode/case/results/term_tree.h"

#include <algorithm>
#include <string>
#include <utility>

#include "pinode/dynamics/library_function.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/study/terms/discovered_problem.h"

namespace pinode {
namespace {

void AppendTo(const char* key, TomlValue table, TomlValue* tree) {
  std::vector<TomlValue> tables;
  if (const TomlValue* present = tree->Find(key)) tables = present->elements;
  tables.push_back(std::move(table));
  tree->Set(key, TomlValue::Array(std::move(tables)));
}

TomlValue GroupTable(const ChangeCandidate& candidate) {
  TomlValue matrix = TomlValue::Table();
  if (candidate.subject.kind == ChangeKind::kMass) {
    matrix.Set("diagonal", TomlValue::Numbers({candidate.masses.begin(),
                                               candidate.masses.end()}));
  } else {
    std::vector<TomlValue> rows;
    for (const auto& row : candidate.matrix.rowwise()) {
      rows.push_back(TomlValue::Numbers({row.begin(), row.end()}));
    }
    matrix = TomlValue::Array(std::move(rows));
  }
  TomlValue group = TomlValue::Table();
  group.Set("name", TomlValue::String(candidate.subject.name));
  group.Set("adds_to",
            TomlValue::String(ChangeKindName(candidate.subject.kind)));
  group.Set("matrix", std::move(matrix));
  group.Set("prior_sigma", TomlValue::Float(PriorOf(candidate)));
  return group;
}

TomlValue LibraryTable(const ChangeCandidate& candidate,
                       const StructuralModel& model) {
  std::vector<std::string> inputs;
  for (const Feature& feature : FeaturesOf(candidate)) {
    const std::string name = feature.Name(model.dof_names, {});
    if (candidate.basis.find(name) != std::string::npos) inputs.push_back(name);
  }
  TomlValue term = TomlValue::Table();
  term.Set("basis", TomlValue::String(candidate.basis));
  term.Set("prior_sigma", TomlValue::Float(PriorOf(candidate)));
  TomlValue library = TomlValue::Table();
  library.Set("name", TomlValue::String(candidate.library));
  library.Set("inputs", TomlValue::Strings(inputs));
  library.Set("output", TomlValue::String(candidate.subject.dof));
  library.Set("acts_as", TomlValue::String("force"));
  library.Set("terms", TomlValue::Array({std::move(term)}));
  return library;
}

TomlValue LibraryTable(const DiscoveredEquation& equation) {
  std::vector<std::string> inputs;
  for (size_t f = 0; f < equation.features.size(); ++f) {
    const bool used = std::any_of(equation.terms.begin(), equation.terms.end(),
                                  [&](const DiscoveredTerm& term) {
                                    return BasisFunction(equation, term.basis)
                                        .DependsOn(static_cast<int>(f));
                                  });
    if (used) inputs.push_back(equation.feature_names[f]);
  }
  // A constant alone depends on no feature; a library has at least one input.
  if (inputs.empty()) inputs.push_back(equation.feature_names[0]);
  std::vector<TomlValue> terms;
  for (const DiscoveredTerm& term : equation.terms) {
    TomlValue table = TomlValue::Table();
    table.Set("basis", TomlValue::String(term.basis));
    // The initial model, with which scores are compared, is the one without the
    // terms.
    table.Set("initial", TomlValue::Float(term.given ? term.coefficient : 0.0));
    if (term.given) table.Set("free", TomlValue::Boolean(false));
    if (term.sign > 0) table.Set("lower", TomlValue::Float(0.0));
    if (term.sign < 0) table.Set("upper", TomlValue::Float(0.0));
    terms.push_back(std::move(table));
  }
  TomlValue library = TomlValue::Table();
  library.Set("name", TomlValue::String(LibraryName(equation)));
  library.Set("inputs", TomlValue::Strings(inputs));
  library.Set("output", TomlValue::String(equation.output));
  library.Set("acts_as", TomlValue::String(equation.acts_as == ActsAs::kForce
                                               ? "force"
                                               : "acceleration"));
  library.Set("terms", TomlValue::Array(std::move(terms)));
  return library;
}

// Transfers curves to the terms that replace the networks.
void RenameCurves(const std::vector<DiscoveredEquation>& equations,
                  TomlValue* tree) {
  TomlValue* tables = tree->Find("reference_curve");
  if (tables == nullptr) return;
  std::vector<TomlValue> curves;
  for (TomlValue curve : tables->elements) {
    const TomlValue* term = curve.Find("term");
    bool kept = true;
    for (const DiscoveredEquation& equation : equations) {
      if (term == nullptr || (term->text != equation.network &&
                              term->text != LibraryName(equation))) {
        continue;
      }
      kept = !equation.terms.empty();
      curve.Set("term", TomlValue::String(LibraryName(equation)));
      break;
    }
    if (kept) curves.push_back(std::move(curve));
  }
  tree->Erase("reference_curve");
  if (!curves.empty()) {
    tree->Set("reference_curve", TomlValue::Array(std::move(curves)));
  }
}

bool IsAmong(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Replaces the tables under `key` by `tables`; if there are none, removes the
// key.
void SetTables(const char* key, std::vector<TomlValue> tables,
               TomlValue* tree) {
  if (tables.empty()) {
    tree->Erase(key);
  } else {
    tree->Set(key, TomlValue::Array(std::move(tables)));
  }
}

// Removes from the section of `law` the terms that were left out; false if no
// term is left.
bool KeepOf(const LawTerm& law, const std::vector<std::string>& left_out,
            TomlValue* table) {
  table->Erase("optional");
  table->Erase("select");
  if (law.type != "library") return !IsAmong(law.name, left_out);
  std::vector<TomlValue> terms;
  TomlValue* all = table->Find("terms");
  for (size_t k = 0; k < all->elements.size(); ++k) {
    if (IsAmong(law.parameters.parameters[k].name, left_out)) continue;
    terms.push_back(std::move(all->elements[k]));
  }
  all->elements = std::move(terms);
  return !all->elements.empty();
}

}  // namespace

TomlValue TreeWithCandidates(TomlValue tree, const StructuralModel& model,
                             const std::vector<ChangeCandidate>& candidates) {
  for (const ChangeCandidate& candidate : candidates) {
    if (candidate.subject.kind != ChangeKind::kNonlinear) {
      AppendTo("group", GroupTable(candidate), &tree);
    } else {
      AppendTo("library", LibraryTable(candidate, model), &tree);
    }
  }
  return tree;
}

TomlValue TreeAfterChoice(TomlValue tree, const StructuralDynamics& dynamics,
                          const std::vector<std::string>& left_out) {
  std::vector<TomlValue> elements;
  std::vector<TomlValue> libraries;
  std::vector<std::string> gone;  // whole laws
  size_t element = 0;
  size_t library = 0;
  for (const LawTerm& law : dynamics.laws()) {
    if (law.type == kMemoryNetworkType) continue;
    const bool is_library = law.type == "library";
    TomlValue table = tree.Find(is_library ? "library" : "element")
                          ->elements[is_library ? library++ : element++];
    if (!KeepOf(law, left_out, &table)) {
      gone.push_back(law.name);
      continue;
    }
    (is_library ? libraries : elements).push_back(std::move(table));
  }
  SetTables("element", std::move(elements), &tree);
  SetTables("library", std::move(libraries), &tree);
  if (const TomlValue* present = tree.Find("reference_curve")) {
    std::vector<TomlValue> curves;
    for (const TomlValue& curve : present->elements) {
      const TomlValue* term = curve.Find("term");
      if (term != nullptr && IsAmong(term->text, gone)) continue;
      curves.push_back(curve);
    }
    SetTables("reference_curve", std::move(curves), &tree);
  }
  return tree;
}

TomlValue TreeWithEquations(TomlValue tree,
                            const std::vector<DiscoveredEquation>& equations,
                            const std::vector<int>& substeps) {
  std::vector<TomlValue> networks;
  if (const TomlValue* tables = tree.Find("network")) {
    networks = tables->elements;
  }
  std::vector<TomlValue> libraries;
  if (const TomlValue* tables = tree.Find("library")) {
    libraries = tables->elements;
  }
  for (const DiscoveredEquation& equation : equations) {
    const auto replaced = [&](const char* key, const std::string& name) {
      return [key, name](const TomlValue& table) {
        const TomlValue* value = table.Find(key);
        return value != nullptr && value->text == name;
      };
    };
    networks.erase(std::remove_if(networks.begin(), networks.end(),
                                  replaced("name", equation.network)),
                   networks.end());
    // Libraries of an earlier round.
    libraries.erase(std::remove_if(libraries.begin(), libraries.end(),
                                   replaced("name", LibraryName(equation))),
                    libraries.end());
    if (!equation.terms.empty()) libraries.push_back(LibraryTable(equation));
  }
  RenameCurves(equations, &tree);
  tree.Erase("discover");
  tree.Erase("network");
  tree.Erase("library");
  if (!libraries.empty()) {
    tree.Set("library", TomlValue::Array(std::move(libraries)));
  }
  if (!networks.empty()) {
    tree.Set("network", TomlValue::Array(std::move(networks)));
  }
  if (!substeps.empty()) {
    std::vector<TomlValue>& records = tree.Find("record")->elements;
    for (size_t r = 0; r < records.size() && r < substeps.size(); ++r) {
      records[r].Set("substeps", TomlValue::Integer(substeps[r]));
    }
  }
  return tree;
}

}  // namespace pinode
