#include "pinode/case/results/grown_case.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/case/results/checkpoint_file.h"
#include "pinode/case/results/term_tree.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/record/table.h"
#include "pinode/study/reduction/renewed_basis.h"

namespace pinode {
namespace {

// Whether both have the same unknowns, in the same order.
bool SameUnknowns(const IdentificationProblem& a,
                  const IdentificationProblem& b) {
  const ParameterLayout first(a);
  const ParameterLayout second(b);
  if (first.num_parameters() != second.num_parameters()) return false;
  for (int i = 0; i < first.num_parameters(); ++i) {
    if (first.parameter(i).name != second.parameter(i).name) return false;
  }
  return true;
}

// `problem` as the case that `tree` says; what is not the problem, such as
// remarks and groups of a finite-element model, is as it is read there.
bool CaseOf(const Case& c, const TomlValue& tree,
            const IdentificationProblem& problem, Case* result,
            std::string* error) {
  Case grown;
  if (!ReadCaseTree(tree, c.path, c.data, CasePurpose::kFit, &grown, error)) {
    return false;
  }
  if (!SameUnknowns(grown.problem, problem)) {
    *error = c.path + ": has other unknowns than the case made from it";
    return false;
  }
  ProblemDescription description = std::move(grown.problem.description);
  for (const std::string& remark : c.problem.description.remarks) {
    if (std::count(description.remarks.begin(), description.remarks.end(),
                   remark) == 0) {
      description.remarks.push_back(remark);
    }
  }
  grown.problem = problem;
  grown.problem.description = std::move(description);
  grown.options = c.options;
  *result = std::move(grown);
  return true;
}

// The case with what a renewal made of it.
Case CaseInBasis(const Case& c, ReducedProblem renewed) {
  TomlValue at = TomlValue::Table();
  for (const auto& [name, value] : renewed.structure.basis_at) {
    at.Set(name, TomlValue::Float(value));
  }
  TomlValue tree = *c.source;
  TomlValue* reduction = tree.Find("model")->Find("reduction");
  CHECK(reduction != nullptr);
  reduction->Set("basis_at", std::move(at));
  Case result = c;
  result.problem = std::move(renewed.problem);
  result.finite_element =
      std::make_shared<const ReducedStructure>(std::move(renewed.structure));
  result.source = std::make_shared<const TomlValue>(std::move(tree));
  return result;
}

// [profiles] without the parameters that the problem does not have any more.
void KeepProfiles(Case* c, TomlValue* tree) {
  if (!c->profiles.has_value() || c->profiles->empty()) return;
  const ParameterLayout layout(c->problem);
  std::vector<std::string> kept;
  for (const std::string& name : *c->profiles) {
    if (layout.FreeIndex(name) >= 0) kept.push_back(name);
  }
  if (kept.size() == c->profiles->size()) return;
  c->problem.description.remarks.push_back(
      "Some parameters in [profiles] are no longer free.");
  // An empty list would stand for all.
  if (kept.empty()) {
    c->profiles.reset();
    tree->Erase("profiles");
    return;
  }
  TomlValue* section = tree->Find("profiles");
  CHECK(section != nullptr);
  section->Set("parameters", TomlValue::Strings(kept));
  c->profiles = std::move(kept);
}

}  // namespace

bool CaseWithCandidates(const Case& c,
                        const std::vector<ChangeCandidate>& candidates,
                        const IdentificationProblem& problem, Case* grown,
                        std::string* error) {
  if (candidates.empty()) {
    *grown = c;
    return true;
  }
  return CaseOf(
      c, TreeWithCandidates(*c.source, c.problem.dynamics->model(), candidates),
      problem, grown, error);
}

bool CaseWithEquations(const Case& c,
                       const std::vector<DiscoveredEquation>& equations,
                       const IdentificationProblem& problem, bool given_steps,
                       Case* grown, std::string* error) {
  std::vector<int> substeps;
  for (const IdentificationRecord& record : problem.records) {
    if (given_steps) substeps.push_back(record.substeps);
  }
  return CaseOf(c, TreeWithEquations(*c.source, equations, substeps), problem,
                grown, error);
}

Case CaseAfterChoice(const Case& c, const std::vector<std::string>& left_out,
                     const IdentificationProblem& problem) {
  TomlValue tree = TreeAfterChoice(*c.source, *c.problem.dynamics, left_out);
  Case result = c;
  result.candidates.clear();
  result.problem = problem;
  KeepProfiles(&result, &tree);
  result.source = std::make_shared<const TomlValue>(std::move(tree));
  return result;
}

bool LeaveOutOfCase(const std::vector<std::string>& left_out, Case* c,
                    std::string* error) {
  std::vector<ModelCandidate> gone;
  for (const std::string& name : left_out) {
    const auto found = std::find_if(c->candidates.begin(), c->candidates.end(),
                                    [&name](const ModelCandidate& candidate) {
                                      return candidate.name == name;
                                    });
    if (found == c->candidates.end()) {
      *error = c->path + ": '" + name +
               "' is not a candidate, expected an optional element or a term "
               "of a library with select = true";
      return false;
    }
    gone.push_back(*found);
  }
  IdentificationProblem problem;
  if (!LeaveOut(c->problem, gone, &problem, error)) {
    *error = c->path + ": " + *error;
    return false;
  }
  *c = CaseAfterChoice(*c, left_out, problem);
  return true;
}

void HoldInCase(const std::map<std::string, double>& values, Case* c) {
  c->problem.dynamics = std::make_shared<const StructuralDynamics>(
      c->problem.dynamics->WithGroupParameters([&values](Parameter* parameter) {
        const auto held = values.find(parameter->name);
        const auto source = values.find(parameter->tie);
        if (held != values.end()) {
          parameter->value = held->second;
        } else if (source != values.end()) {
          parameter->value = parameter->tie_factor * source->second;
        } else {
          return;
        }
        parameter->free = false;
        parameter->tie.clear();
      }));
  TomlValue tree = *c->source;
  for (TomlValue& group : tree.Find("group")->elements) {
    const std::string name = group.Find("name")->text;
    for (const GroupCurve& curve : c->problem.dynamics->group_curves()) {
      const std::vector<Parameter>& knots = curve.parameters.parameters;
      if (curve.name != name || values.count(knots[0].name) == 0) continue;
      std::vector<double> changes;
      for (const Parameter& knot : knots) changes.push_back(knot.value);
      changes.insert(changes.begin() + curve.reference, 0.0);
      group.Find("follows")->Set("values", TomlValue::Numbers(changes));
      group.Find("follows")->Set("free", TomlValue::Boolean(false));
    }
    const auto held = values.find(name);
    const TomlValue* tie = group.Find("tie");
    const auto source = tie == nullptr ? values.end() : values.find(tie->text);
    double value = 0.0;
    if (held != values.end()) {
      value = held->second;
    } else if (source != values.end()) {
      const TomlValue* factor = group.Find("tie_factor");
      value = source->second * (factor == nullptr ? 1.0 : factor->number);
    } else {
      continue;
    }
    group.Erase("tie");
    group.Erase("tie_factor");
    group.Set("initial", TomlValue::Float(value));
    group.Set("free", TomlValue::Boolean(false));
  }
  KeepProfiles(c, &tree);
  c->source = std::make_shared<const TomlValue>(std::move(tree));
}

bool ReadFittedModel(const std::string& folder, Case* c, IdentifiedModel* model,
                     std::string* error) {
  Checkpoint checkpoint;
  if (!ReadCheckpoint(folder + "/checkpoint.json", c->problem, &checkpoint,
                      error) ||
      !LeaveOutOfCase(checkpoint.choice.left_out, c, error)) {
    return false;
  }
  *model = checkpoint.model;
  return !RenewsBasis(*c) || RenewCase(*c, checkpoint.model, c, model, error);
}

bool RenewsBasis(const Case& c) {
  return c.finite_element != nullptr && c.finite_element->renew_basis;
}

bool RenewCase(const Case& c, const IdentifiedModel& model, Case* renewed,
               IdentifiedModel* begin, std::string* error) {
  CHECK(c.finite_element != nullptr);
  ReducedProblem result;
  if (!RenewBasis({c.problem, *c.finite_element}, model, &result, begin,
                  error)) {
    *error = c.path + ": [model.reduction]: " + *error;
    return false;
  }
  *renewed = CaseInBasis(c, std::move(result));
  return true;
}

void TakeOver(IdentificationProblem problem,
              const std::shared_ptr<const ReducedStructure>& reduced,
              const IdentificationSummary& summary, Case* c) {
  const ModelChoice& choice = summary.choice;
  // A choice that was interrupted before its first step has changed nothing.
  const bool begun = !choice.left_out.empty() ||
                     summary.termination != Termination::kInterrupted;
  if (!choice.empty() && begun) {
    *c = CaseAfterChoice(*c, choice.left_out, problem);
  } else {
    c->problem = std::move(problem);
  }
  if (c->finite_element == nullptr || reduced == c->finite_element) return;
  // CaseAfterChoice may have added remarks to the problem.
  IdentificationProblem fitted = std::move(c->problem);
  *c = CaseInBasis(*c, {std::move(fitted), *reduced});
}

}  // namespace pinode
