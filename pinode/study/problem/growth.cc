#include "pinode/study/problem/growth.h"

#include <algorithm>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/problem/substeps.h"

namespace pinode {

std::string TermName(std::string text) {
  for (char& c : text) {
    if (std::string("/\\:*?\"'<>|&;%$#@!~`^(){}=").find(c) !=
        std::string::npos) {
      c = '_';
    }
  }
  return text;
}

StructureTerms TermsOf(const StructuralDynamics& dynamics) {
  StructureTerms terms;
  terms.groups = dynamics.groups();
  for (const LawTerm& term : dynamics.laws()) terms.laws.push_back(term);
  for (const UnknownForceTerm& term : dynamics.unknown_forces()) {
    terms.unknown_forces.push_back(term);
  }
  for (const GroupCurve& curve : dynamics.group_curves()) {
    terms.group_curves.push_back(curve);
  }
  for (const NetworkTerm& term : dynamics.networks()) {
    terms.networks.push_back(term);
  }
  for (int i = 0; i < dynamics.num_terms(); ++i) {
    const TermKind kind = dynamics.term(i).kind();
    if (kind != TermKind::kOther && kind != TermKind::kForceScale) continue;
    terms.others.push_back(dynamics.term(i).Clone());
  }
  return terms;
}

bool Assemble(const StructuralModel& model,
              const std::vector<InputSpec>& inputs, const StructureTerms& terms,
              std::shared_ptr<const StructuralDynamics>* dynamics,
              std::string* error) {
  auto result = std::make_shared<StructuralDynamics>(model, inputs);
  for (const GroupTerm& term : terms.groups) {
    if (!result->AddGroup(term, error)) return false;
  }
  for (const LawTerm& term : terms.laws) {
    if (!result->AddLaw(term, error)) return false;
  }
  for (const UnknownForceTerm& term : terms.unknown_forces) {
    if (!result->AddUnknownForce(term, error)) return false;
  }
  for (const GroupCurve& curve : terms.group_curves) {
    if (!result->AddGroupCurve(curve, error)) return false;
  }
  for (const NetworkTerm& term : terms.networks) {
    if (!result->AddNetwork(term, error)) return false;
  }
  for (const std::shared_ptr<const Term>& term : terms.others) {
    if (!result->AddTerm(term->Clone(), error)) return false;
  }
  StructuralDynamics::Prepared prepared;
  if (!result->Prepare(result->Parameters(), &prepared, error)) return false;
  *dynamics = std::move(result);
  return true;
}

bool SetStepsAgain(const std::vector<int>& substeps,
                   IdentificationProblem* problem, std::string* error) {
  if (!substeps.empty() && substeps.size() != problem->records.size()) {
    *error = "there are steps for " + std::to_string(substeps.size()) +
             " records, expected " + std::to_string(problem->records.size());
    return false;
  }
  for (size_t r = 0; r < problem->records.size(); ++r) {
    IdentificationRecord& record = problem->records[r];
    if (!substeps.empty()) {
      record.substeps = substeps[r];
      record.substeps_chosen = false;
    } else if (record.substeps_chosen) {
      record.substeps = 0;
    }
  }
  std::vector<SubstepChoice> choices;
  int failed = 0;
  return SetSubsteps(problem, &choices, &failed, error);
}

bool IsFitOf(const IdentificationProblem& problem, const FitSummary& summary,
             const IdentifiedModel& model, std::string* error) {
  if (!problem.IsValid(error)) return false;
  const ParameterLayout layout(problem);
  const size_t num_records = problem.records.size();
  if (model.parameters.size() != layout.num_parameters() ||
      !model.parameters.allFinite()) {
    *error = "the fit has " + std::to_string(model.parameters.size()) +
             " parameters, expected the problem's " +
             std::to_string(layout.num_parameters()) + ", all finite";
    return false;
  }
  if (model.sigmas.size() != num_records ||
      summary.records.size() != num_records) {
    *error = "the fit is not of the problem's " + std::to_string(num_records) +
             " records";
    return false;
  }
  for (size_t r = 0; r < num_records; ++r) {
    const IdentificationRecord& record = problem.records[r];
    const RecordScore& score = summary.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    if (static_cast<size_t>(model.sigmas[r].size()) != record.channels.size() ||
        (score.finite &&
         (score.states.rows() != problem.dynamics->num_states() ||
          score.states.cols() != record.num_samples()))) {
      *error = "the fit has other channels, states or samples than record '" +
               record.name + "'";
      return false;
    }
  }
  return true;
}

bool IsUsableResultOf(const IdentificationProblem& problem,
                      const IdentificationSummary& summary,
                      const IdentifiedModel& model, std::string* error) {
  if (!IsFitOf(problem, summary, model, error)) return false;
  if (!summary.usable()) {
    *error = "the fit is not usable: " + summary.message;
    return false;
  }
  const auto size = static_cast<Eigen::Index>(summary.covariance_names.size());
  if (size == 0 || summary.covariance.rows() != size ||
      summary.covariance.cols() != size) {
    *error = "the fit has no covariance";
    return false;
  }
  return true;
}

std::map<std::string, double> ParametersByName(
    const IdentificationProblem& problem, const IdentifiedModel& model) {
  const ParameterLayout layout(problem);
  CHECK_EQ(model.parameters.size(), layout.num_parameters());
  std::map<std::string, double> values;
  for (int i = 0; i < layout.num_parameters(); ++i) {
    values[layout.parameter(i).name] = model.parameters[i];
  }
  return values;
}

IdentifiedModel BeginFrom(const std::map<std::string, double>& values,
                          const IdentifiedModel& model,
                          const IdentificationProblem& problem) {
  const ParameterLayout layout(problem);
  IdentifiedModel start;
  start.parameters = layout.InitialValues();
  for (int i = 0; i < layout.num_parameters(); ++i) {
    const auto found = values.find(layout.parameter(i).name);
    if (found != values.end()) start.parameters[i] = found->second;
  }
  start.sigmas = model.sigmas;
  start.starts = model.starts;
  return start;
}

}  // namespace pinode
