#include "pinode/study/terms/discovered_problem.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/terms/library_term.h"

namespace pinode {
namespace {

LibrarySpec SpecOf(const DiscoveredEquation& equation) {
  LibrarySpec spec;
  spec.name = LibraryName(equation);
  spec.features = equation.features;
  spec.output = equation.output;
  spec.acts_as = equation.acts_as;
  for (const DiscoveredTerm& term : equation.terms) {
    LibrarySpec::Coefficient coefficient;
    coefficient.basis = term.basis;
    Parameter& parameter = coefficient.parameter;
    // The initial model, with which scores are compared, is the one without the
    // terms.
    parameter.value = term.given ? term.coefficient : 0.0;
    parameter.prior_mean = parameter.value;
    parameter.free = !term.given;
    if (term.sign > 0) parameter.lower = 0.0;
    if (term.sign < 0) parameter.upper = 0.0;
    spec.coefficients.push_back(std::move(coefficient));
  }
  return spec;
}

template <typename Term>
void EraseNamed(const std::string& name, std::vector<Term>* terms) {
  terms->erase(
      std::remove_if(terms->begin(), terms->end(),
                     [&name](const Term& term) { return term.name == name; }),
      terms->end());
}

bool ReplaceNetworks(const std::vector<DiscoveredEquation>& equations,
                     IdentificationProblem* problem, std::string* error) {
  const StructuralDynamics& before = *problem->dynamics;
  StructureTerms terms = TermsOf(before);
  for (const DiscoveredEquation& equation : equations) {
    EraseNamed(equation.network, &terms.networks);
    EraseNamed(LibraryName(equation), &terms.laws);
    if (equation.terms.empty()) continue;
    LawTerm library;
    if (!MakeLibraryTerm(SpecOf(equation), before, problem->description.units,
                         &library, error)) {
      return false;
    }
    terms.laws.push_back(std::move(library));
  }
  return Assemble(before.model(), before.inputs(), terms, &problem->dynamics,
                  error);
}

// Updates the description: remarks on networks go with them, curves are
// transferred to the replacing terms.
void Redescribe(const std::vector<DiscoveredEquation>& equations,
                ProblemDescription* description) {
  description->known_as.clear();
  for (const DiscoveredEquation& equation : equations) {
    EraseNamed(equation.network, &description->force_truths);
    std::vector<std::string>& remarks = description->remarks;
    const std::string begin = "network '" + equation.network + "' ";
    remarks.erase(std::remove_if(remarks.begin(), remarks.end(),
                                 [&begin](const std::string& remark) {
                                   return remark.rfind(begin, 0) == 0;
                                 }),
                  remarks.end());
  }
  std::vector<ReferenceCurve> curves;
  for (ReferenceCurve& curve : description->reference_curves) {
    bool kept = true;
    for (const DiscoveredEquation& equation : equations) {
      if (curve.term != equation.network &&
          curve.term != LibraryName(equation)) {
        continue;
      }
      kept = !equation.terms.empty();
      curve.term = LibraryName(equation);
      break;
    }
    if (kept) curves.push_back(std::move(curve));
  }
  description->reference_curves = std::move(curves);
}

}  // namespace

std::string LibraryName(const DiscoveredEquation& equation) {
  return TermName(equation.network + "_" + equation.output);
}

std::string CoefficientName(const DiscoveredEquation& equation,
                            const std::string& basis) {
  return LibraryName(equation) + "." + basis;
}

LibraryFunction BasisFunction(const DiscoveredEquation& equation,
                              const std::string& basis) {
  LibraryFunction function;
  std::string error;
  CHECK(
      LibraryFunction::Parse(basis, equation.feature_names, &function, &error))
      << error;
  return function;
}

bool AreEquationsOf(const IdentificationProblem& problem,
                    const std::vector<DiscoveredEquation>& equations,
                    std::string* error) {
  for (const DiscoveredEquation& equation : equations) {
    if (equation.feature_names.size() != equation.features.size()) {
      *error = "the equation at '" + equation.output +
               "' has not a name for every feature";
      return false;
    }
    LibrarySpec spec = SpecOf(equation);
    for (const DiscoveryCandidate& candidate : equation.candidates) {
      spec.coefficients.push_back({candidate.basis, Parameter()});
    }
    if (spec.coefficients.empty()) continue;
    LawTerm unused;
    if (!MakeLibraryTerm(spec, *problem.dynamics, problem.description.units,
                         &unused, error)) {
      return false;
    }
    LibraryFunction function;
    for (const LibrarySpec::Coefficient& coefficient : spec.coefficients) {
      if (!LibraryFunction::Parse(coefficient.basis, equation.feature_names,
                                  &function, error)) {
        *error = "the equation at '" + equation.output + "': " + *error;
        return false;
      }
    }
  }
  return true;
}

bool MakeDiscoveredProblem(const IdentificationProblem& problem,
                           const IdentifiedModel& model,
                           const std::vector<DiscoveredEquation>& equations,
                           const std::vector<int>& substeps,
                           IdentificationProblem* discovered,
                           IdentifiedModel* initial, std::string* error) {
  if (model.parameters.size() != ParameterLayout(problem).num_parameters()) {
    *error = "the model has " + std::to_string(model.parameters.size()) +
             " parameters, expected the problem's " +
             std::to_string(ParameterLayout(problem).num_parameters());
    return false;
  }
  IdentificationProblem result = problem;
  if (!ReplaceNetworks(equations, &result, error) ||
      !SetStepsAgain(substeps, &result, error) || !result.IsValid(error)) {
    return false;
  }
  Redescribe(equations, &result.description);
  std::map<std::string, double> values = ParametersByName(problem, model);
  // The equations replace the libraries of an earlier round.
  for (const DiscoveredEquation& equation : equations) {
    for (const DiscoveredTerm& term : equation.terms) {
      values[CoefficientName(equation, term.basis)] = term.coefficient;
    }
  }
  *initial = BeginFrom(values, model, result);
  *discovered = std::move(result);
  return true;
}

}  // namespace pinode
