#include "pinode/case/renewed_basis.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/case/checkpoint_file.h"
#include "pinode/case/finite_element_section.h"
#include "pinode/case/toml_value.h"

namespace pinode {
namespace {

constexpr int kMaxRenewals = 5;
// Of a standard error. Each renewal leaves a small part of the last one's move.
constexpr double kSettled = 0.3;

// Whether the basis depends on the group, one of the finite-element model.
bool ShapesBasis(const GroupTerm& term, const FiniteElementCase::Group& group) {
  return group.matrix.rows() > 0 &&
         term.group.target != MatrixGroup::Target::kDamping &&
         term.follows == GroupTerm::Follows::kNothing;
}

// The farthest that a group which shapes the basis went, in standard errors.
double LargestMove(const Case& c, const IdentificationSummary& before,
                   const IdentificationSummary& after) {
  double largest = 0.0;
  const std::vector<GroupTerm>& groups = c.problem.dynamics->groups();
  for (size_t i = 0; i < after.parameters.size(); ++i) {
    const ParameterEstimate& now = after.parameters[i];
    for (size_t j = 0; j < groups.size(); ++j) {
      if (groups[j].alpha.name != now.name || !(now.sigma > 0.0) ||
          !ShapesBasis(groups[j], c.finite_element->groups[j])) {
        continue;
      }
      largest =
          std::max(largest, std::abs(now.value - before.parameters[i].value) /
                                now.sigma);
    }
  }
  return largest;
}

}  // namespace

bool RenewsBasis(const Case& c) {
  return c.finite_element != nullptr && c.finite_element->renew_basis;
}

bool RenewBasis(const Case& c, const IdentifiedModel& model, Case* renewed,
                IdentifiedModel* begin, std::string* error) {
  CHECK(c.finite_element != nullptr);
  const std::map<std::string, double> values =
      ParametersByName(c.problem, model);
  TomlValue at = TomlValue::Table();
  const std::vector<GroupTerm>& groups = c.problem.dynamics->groups();
  CHECK_EQ(groups.size(), c.finite_element->groups.size());
  for (size_t j = 0; j < groups.size(); ++j) {
    if (!ShapesBasis(groups[j], c.finite_element->groups[j])) continue;
    const std::string& name = groups[j].alpha.name;
    at.Set(name, TomlValue::Float(values.at(name)));
  }
  TomlValue tree = *c.source;
  TomlValue* reduction = tree.Find("model")->Find("reduction");
  CHECK(reduction != nullptr);
  reduction->Set("basis_at", std::move(at));
  Case result;
  if (!RebuildCase(c, tree, &result, error)) return false;
  result.problem.description.known_as = ProblemIdentity(c.problem);
  *begin = BeginFrom(values, model, result.problem);
  *renewed = std::move(result);
  return true;
}

void RenewBasisUntilSettled(const FitFunction& fit, Case* c,
                            IdentificationSummary* summary,
                            IdentifiedModel* model) {
  Case now = *c;
  IdentificationSummary summary_now = *summary;
  IdentifiedModel model_now = *model;
  std::string remark;
  for (int round = 1; round <= kMaxRenewals; ++round) {
    Case next;
    IdentifiedModel begin;
    std::string problem;
    if (!RenewBasis(now, model_now, &next, &begin, &problem)) {
      remark = "could not be renewed: " + problem;
      break;
    }
    BeginNearTheEnd(&next.options);
    IdentificationSummary summary_next;
    IdentifiedModel model_next;
    fit("basis " + std::to_string(round), next, &begin, &summary_next,
        &model_next);
    if (summary_next.termination == Termination::kInterrupted) {
      summary->termination = Termination::kInterrupted;
      summary->usable = false;
      summary->message = "interrupted while the basis was being renewed";
      return;
    }
    if (!summary_next.usable) {
      remark = "could not be renewed: " + summary_next.message;
      break;
    }
    const double moved = LargestMove(next, summary_now, summary_next);
    next.options = c->options;
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
  *c = std::move(now);
  *summary = std::move(summary_now);
  *model = std::move(model_now);
}

}  // namespace pinode
