#include "pinode/study/terms/model_candidate.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/dynamics/elements.h"
#include "pinode/dynamics/library_law.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/problem/checkpoint.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

const LawTerm* FindLaw(const StructuralDynamics& dynamics,
                       const ModelCandidate& candidate) {
  for (const LawTerm& law : dynamics.laws()) {
    if (law.name == candidate.law) return &law;
  }
  return nullptr;
}

bool HasParameter(const LawTerm& law, const std::string& name, bool free) {
  return std::any_of(
      law.parameters.parameters.begin(), law.parameters.parameters.end(),
      [&](const Parameter& parameter) {
        return parameter.name == name && (parameter.free || !free);
      });
}

bool IsThere(const StructuralDynamics& dynamics,
             const ModelCandidate& candidate, std::string* error) {
  const LawTerm* law = FindLaw(dynamics, candidate);
  bool there = law != nullptr && !candidate.parameters.empty() &&
               (!candidate.is_library_term ||
                dynamic_cast<const LibraryLaw*>(law->law.get()) != nullptr);
  for (const std::string& name : candidate.parameters) {
    there = there && HasParameter(*law, name, false);
  }
  if (!there) {
    *error = "the candidate '" + candidate.name +
             "' is not a term of the model; name one of its terms";
  }
  return there;
}

// Removes some functions from the library, which keeps its features. Returns
// false if no function is left.
bool WithoutFunctions(const std::set<std::string>& names, LawTerm* term) {
  const auto& law = dynamic_cast<const LibraryLaw&>(*term->law);
  std::vector<LibraryFunction> functions;
  std::vector<Parameter> parameters;
  for (size_t k = 0; k < law.functions().size(); ++k) {
    const Parameter& parameter = term->parameters.parameters[k];
    if (names.count(parameter.name) > 0) continue;
    functions.push_back(law.functions()[k]);
    parameters.push_back(parameter);
  }
  if (functions.empty()) return false;
  term->law =
      std::make_shared<LibraryLaw>(law.num_features(), std::move(functions));
  term->parameters.parameters = std::move(parameters);
  return true;
}

std::vector<LawTerm> RemainingLaws(
    const std::vector<LawTerm>& laws,
    const std::vector<ModelCandidate>& candidates) {
  std::set<std::string> whole;
  std::map<std::string, std::set<std::string>> functions;
  for (const ModelCandidate& candidate : candidates) {
    if (candidate.is_library_term) {
      functions[candidate.law].insert(candidate.parameters.begin(),
                                      candidate.parameters.end());
    } else {
      whole.insert(candidate.law);
    }
  }
  std::vector<LawTerm> remaining;
  for (LawTerm term : laws) {
    if (whole.count(term.name) > 0) continue;
    const auto found = functions.find(term.name);
    if (found != functions.end() && !WithoutFunctions(found->second, &term)) {
      continue;
    }
    remaining.push_back(std::move(term));
  }
  return remaining;
}

// Returns the entries of a state by name, 0 for those that `from` lacks.
Vector MapState(const std::vector<std::string>& from, const Vector& state,
                const std::vector<std::string>& to) {
  std::map<std::string, double> values;
  for (size_t i = 0; i < from.size(); ++i) {
    values[from[i]] = state[static_cast<Eigen::Index>(i)];
  }
  Vector result = Vector::Zero(static_cast<Eigen::Index>(to.size()));
  for (size_t i = 0; i < to.size(); ++i) {
    const auto found = values.find(to[i]);
    if (found != values.end()) {
      result[static_cast<Eigen::Index>(i)] = found->second;
    }
  }
  return result;
}

}  // namespace

ModelCandidate LibraryCandidate(const LawTerm& library, int function) {
  const std::string& name =
      library.parameters.parameters[static_cast<size_t>(function)].name;
  ModelCandidate candidate;
  candidate.name = name;
  candidate.law = library.name;
  candidate.parameters = {name};
  candidate.amplitudes = {name};
  candidate.is_library_term = true;
  return candidate;
}

ModelCandidate ElementCandidate(
    const LawTerm& element, const std::vector<ElementParameterInfo>& infos) {
  ModelCandidate candidate;
  candidate.name = element.name;
  candidate.law = element.name;
  CHECK_EQ(infos.size(), element.parameters.parameters.size());
  for (size_t k = 0; k < infos.size(); ++k) {
    const std::string& name = element.parameters.parameters[k].name;
    candidate.parameters.push_back(name);
    // Laws are linear in parameters that have the dimension of a force.
    if (infos[k].force_power != 0.0) candidate.amplitudes.push_back(name);
  }
  return candidate;
}

bool AreCandidatesOf(const IdentificationProblem& problem,
                     const std::vector<ModelCandidate>& candidates,
                     std::string* error) {
  if (candidates.empty()) return true;
  const StructuralDynamics& dynamics = *problem.dynamics;
  std::set<std::string> seen;
  for (const ModelCandidate& candidate : candidates) {
    if (!IsThere(dynamics, candidate, error)) return false;
    if (!seen.insert(candidate.name).second) {
      *error = "the candidate '" + candidate.name + "' is given twice";
      return false;
    }
    const LawTerm& law = *FindLaw(dynamics, candidate);
    const bool free =
        std::any_of(candidate.amplitudes.begin(), candidate.amplitudes.end(),
                    [&law](const std::string& name) {
                      return HasParameter(law, name, true);
                    });
    if (!free) {
      *error =
          "'" + candidate.name +
          "' is optional, but no coefficient of its force is free; free one";
      return false;
    }
  }
  if (problem.num_train_records() == 0) {
    *error =
        "'" + candidates[0].name +
        "' is optional, but there is no training record to judge it; add one";
    return false;
  }
  if (ParameterLayout(problem).num_decay_groups() > 0) {
    *error = "'" + candidates[0].name +
             "' is optional, but a network, a spline of a force or a table of "
             "a group can replace it; remove one of them";
    return false;
  }
  return true;
}

bool LeaveOut(const IdentificationProblem& problem,
              const std::vector<ModelCandidate>& candidates,
              IdentificationProblem* result, std::string* error) {
  const StructuralDynamics& before = *problem.dynamics;
  for (const ModelCandidate& candidate : candidates) {
    if (!IsThere(before, candidate, error)) return false;
  }
  StructureTerms terms = TermsOf(before);
  terms.laws = RemainingLaws(terms.laws, candidates);
  IdentificationProblem rest = problem;
  if (!Assemble(before.model(), before.inputs(), terms, &rest.dynamics,
                error)) {
    return false;
  }
  const std::vector<std::string> from = before.StateNames();
  const std::vector<std::string> to = rest.dynamics->StateNames();
  for (IdentificationRecord& record : rest.records) {
    if (record.start != IdentificationRecord::Start::kKnown) continue;
    record.known_start = MapState(from, record.known_start, to);
  }
  std::vector<ReferenceCurve>& curves = rest.description.reference_curves;
  const auto is_gone = [&](const std::string& term) {
    const auto named = [&term](const LawTerm& law) { return law.name == term; };
    const auto had = before.laws();
    const auto has = rest.dynamics->laws();
    return std::any_of(had.begin(), had.end(), named) &&
           std::none_of(has.begin(), has.end(), named);
  };
  curves.erase(std::remove_if(curves.begin(), curves.end(),
                              [&](const ReferenceCurve& curve) {
                                return is_gone(curve.term);
                              }),
               curves.end());
  rest.description.known_as = ProblemIdentity(problem);
  if (!rest.IsValid(error)) return false;
  *result = std::move(rest);
  return true;
}

IdentifiedModel ModelOfOther(const IdentificationProblem& problem,
                             const IdentifiedModel& model,
                             const IdentificationProblem& other) {
  IdentifiedModel result =
      BeginFrom(ParametersByName(problem, model), model, other);
  const std::vector<std::string> from = problem.dynamics->StateNames();
  const std::vector<std::string> to = other.dynamics->StateNames();
  for (Vector& start : result.starts) {
    if (start.size() != static_cast<Eigen::Index>(from.size())) {
      start.resize(0);
      continue;
    }
    start = MapState(from, start, to);
  }
  result.decays = model.decays;
  return result;
}

}  // namespace pinode
