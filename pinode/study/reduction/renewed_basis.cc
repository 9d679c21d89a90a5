#include "pinode/study/reduction/renewed_basis.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/problem/checkpoint.h"

namespace pinode {
namespace {

constexpr int kMaxRenewals = 5;
// Of a standard error. Each renewal leaves a small part of the last one's move.
constexpr double kSettled = 0.3;

// Whether the basis depends on the group, one of the finite-element model.
bool ShapesBasis(const GroupTerm& term, const ReducedStructure::Group& group) {
  return group.matrix.rows() > 0 &&
         term.group.target != MatrixGroup::Target::kDamping &&
         term.follows == GroupTerm::Follows::kNothing;
}

// The farthest that a group which shapes the basis went, in standard errors.
double LargestMove(const ReducedProblem& problem, const FitSummary& before,
                   const FitSummary& after) {
  double largest = 0.0;
  const std::vector<GroupTerm>& groups = problem.problem.dynamics->groups();
  for (const ParameterEstimate& now : after.parameters) {
    const auto then = std::find_if(
        before.parameters.begin(), before.parameters.end(),
        [&now](const ParameterEstimate& p) { return p.name == now.name; });
    if (then == before.parameters.end() || !(now.sigma > 0.0)) continue;
    for (size_t j = 0; j < groups.size(); ++j) {
      if (groups[j].alpha.name != now.name ||
          !ShapesBasis(groups[j], problem.structure.groups[j])) {
        continue;
      }
      largest =
          std::max(largest, std::abs(now.value - then->value) / now.sigma);
    }
  }
  return largest;
}

// Whether the groups of the dynamics are those of the structure.
bool FitTogether(const ReducedProblem& from, const IdentifiedModel& model,
                 std::string* error) {
  if (!from.problem.IsValid(error)) return false;
  if (from.problem.dynamics->groups().size() != from.structure.groups.size() ||
      from.structure.reduced.basis.cols() !=
          from.problem.dynamics->num_dofs()) {
    *error = "the problem's model is not that of the reduced structure";
    return false;
  }
  if (model.parameters.size() !=
      ParameterLayout(from.problem).num_parameters()) {
    *error = "the model has other parameters than the problem";
    return false;
  }
  return true;
}

// The dynamics of from.problem on the structure as it is now.
bool Rebuild(const IdentificationProblem& from, ReducedStructure* structure,
             IdentificationProblem* problem, std::string* error) {
  StructuralModel model;
  if (!Reduce(structure, error) ||
      !MakeReducedModel(structure, &model, error) || !model.IsValid(error)) {
    return false;
  }
  const StructuralDynamics& before = *from.dynamics;
  if (model.dof_names != before.model().dof_names) {
    *error = "the reduction has other coordinates there";
    return false;
  }
  StructureTerms terms = TermsOf(before);
  for (size_t j = 0; j < terms.groups.size(); ++j) {
    MatrixGroup& group = terms.groups[j].group;
    if (!GroupInBasis(*structure, &structure->groups[j], &group.matrix,
                      error)) {
      return false;
    }
    for (GroupCurve& curve : terms.group_curves) {
      if (curve.name == group.name) curve.group.matrix = group.matrix;
    }
  }
  *problem = from;
  return Assemble(model, before.inputs(), terms, &problem->dynamics, error) &&
         SetStepsAgain({}, problem, error) && problem->IsValid(error);
}

}  // namespace

std::vector<GroupAtBasis> GroupsOfBasis(const ReducedProblem& from,
                                        const IdentifiedModel& model) {
  std::vector<GroupAtBasis> at;
  const std::vector<GroupTerm>& groups = from.problem.dynamics->groups();
  for (size_t j = 0; j < groups.size(); ++j) {
    const ReducedStructure::Group& group = from.structure.groups[j];
    if (!ShapesBasis(groups[j], group)) continue;
    // Groups come first in the flat vector.
    at.push_back({groups[j].alpha.name, groups[j].group.target, &group.matrix,
                  model.parameters[static_cast<Eigen::Index>(j)]});
  }
  return at;
}

bool RenewBasis(const ReducedProblem& from, const IdentifiedModel& model,
                ReducedProblem* renewed, IdentifiedModel* begin,
                std::string* error) {
  if (!FitTogether(from, model, error)) return false;
  ReducedProblem result;
  result.structure = from.structure;
  if (!SetBasisPoint(GroupsOfBasis(from, model), &result.structure, error) ||
      !Rebuild(from.problem, &result.structure, &result.problem, error)) {
    return false;
  }
  result.problem.description.known_as = ProblemIdentity(from.problem);
  *begin =
      BeginFrom(ParametersByName(from.problem, model), model, result.problem);
  *renewed = std::move(result);
  return true;
}

void RenewBasisUntilSettled(const IdentificationOptions& options, InnerFit* fit,
                            ReducedProblem* from, FitSummary* summary,
                            IdentifiedModel* model) {
  IdentificationOptions near = options;
  BeginNearTheEnd(&near);
  ReducedProblem now = *from;
  FitSummary summary_now = *summary;
  IdentifiedModel model_now = *model;
  std::string remark;
  for (int round = 1; round <= kMaxRenewals; ++round) {
    ReducedProblem next;
    IdentifiedModel begin;
    std::string error;
    if (!RenewBasis(now, model_now, &next, &begin, &error)) {
      remark = "could not be renewed: " + error;
      break;
    }
    FitSummary summary_next;
    IdentifiedModel model_next;
    fit->Run("basis " + std::to_string(round), next.problem, near, &begin,
             &summary_next, &model_next);
    if (summary_next.termination == Termination::kInterrupted) {
      summary->termination = Termination::kInterrupted;
      summary->message = "interrupted while the basis was being renewed";
      return;
    }
    const std::string why_not = WhyNotSound(near.tuning.gaps, summary_next);
    if (!why_not.empty()) {
      remark = "could not be renewed: " + why_not;
      break;
    }
    const double moved = LargestMove(next, summary_now, summary_next);
    now = std::move(next);
    summary_now = std::move(summary_next);
    model_now = std::move(model_next);
    remark = "was taken again at the values found, " + std::to_string(round) +
             (round > 1 ? " times" : " time") +
             "; the last time they moved by at most " + FormatNumber(moved, 2) +
             " standard errors";
    if (moved <= kSettled) break;
  }
  now.problem.description.remarks.push_back("The basis of the reduction " +
                                            remark + ".");
  *from = std::move(now);
  *summary = std::move(summary_now);
  *model = std::move(model_now);
}

}  // namespace pinode
