#include "pinode/study/damage/mass_instead.h"

#include <cmath>
#include <memory>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/explanations/catalogue.h"
#include "pinode/study/explanations/suspect.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

// A prior of the baselines for each group that has not changed.
struct Kept {
  std::string name;
  double mean = 0.0;
  double sigma = 0.0;
};

std::vector<Kept> KeptGroups(const std::vector<std::string>& groups,
                             const std::vector<GroupState>& healthy,
                             const std::map<std::string, double>& changed) {
  std::vector<Kept> kept;
  for (size_t j = 0; j < groups.size(); ++j) {
    if (changed.count(groups[j]) > 0) continue;
    const auto i = static_cast<Eigen::Index>(j);
    const double count = static_cast<double>(healthy.size());
    Kept one;
    one.name = groups[j];
    for (const GroupState& state : healthy) one.mean += state.values[i] / count;
    double variance = 0.0;
    for (const GroupState& state : healthy) {
      variance +=
          (state.covariance(i, i) + std::pow(state.values[i] - one.mean, 2)) /
          count;
    }
    one.sigma = std::sqrt(variance);
    kept.push_back(std::move(one));
  }
  return kept;
}

// Gives the groups their priors.
bool SetKept(const std::vector<Kept>& kept, IdentificationProblem* problem) {
  const std::shared_ptr<const StructuralDynamics> base = problem->dynamics;
  StructureTerms terms = TermsOf(*base);
  for (GroupTerm& term : terms.groups) {
    for (const Kept& one : kept) {
      if (term.group.name != one.name) continue;
      term.alpha.prior_mean = one.mean;
      term.alpha.prior_sigma = one.sigma;
    }
  }
  std::string unused;
  return Assemble(base->model(), base->inputs(), terms, &problem->dynamics,
                  &unused);
}

class Comparison {
 public:
  Comparison(const IdentificationProblem& problem,
             const IdentificationOptions& options, const IdentifiedModel& model,
             InnerFit* inner)
      : problem_(problem), options_(options), model_(model), inner_(*inner) {
    BeginNearTheEnd(&options_);
    options_.num_starts = 0;
  }

  // Half the squared errors of a fit with these groups kept and with `mass`, in
  // standard deviations; infinite if there is none. `changed`: groups that
  // begin with these values, and all others as they are kept.
  double Cost(const std::vector<Kept>& kept,
              const std::map<std::string, double>& changed, const Suspect* mass,
              FitSummary* fit) {
    IdentificationProblem problem = problem_;
    std::string unused;
    if (!SetKept(kept, &problem) ||
        (mass != nullptr && !AddSuspects({*mass}, &problem, &unused))) {
      return kInfinity;
    }
    std::map<std::string, double> values = ParametersByName(problem_, model_);
    if (!changed.empty()) {
      for (const Kept& one : kept) values[one.name] = one.mean;
      for (const auto& [name, value] : changed) values[name] = value;
    }
    const IdentifiedModel begin = BeginFrom(values, model_, problem);
    IdentifiedModel end;
    inner_.Run("a mass instead", problem, options_, &begin, fit, &end);
    if (fit->termination == Termination::kFailure ||
        fit->termination == Termination::kInterrupted) {
      return kInfinity;
    }
    double cost = fit->final_modal_cost;
    for (const Kept& one : kept) {
      const ParameterEstimate* estimate = FindEstimate(*fit, one.name);
      if (estimate == nullptr) continue;
      cost += 0.5 * std::pow((estimate->value - one.mean) / one.sigma, 2);
    }
    return cost;
  }

 private:
  const IdentificationProblem& problem_;
  IdentificationOptions options_;
  const IdentifiedModel& model_;
  InnerFit& inner_;
};

std::string Describe(const Suspect& mass, const FitSummary& fit) {
  const ParameterEstimate* estimate = FindEstimate(fit, mass.Unknowns()[0]);
  if (estimate == nullptr) return mass.what;
  const auto percent = [](double value) {
    return FormatNumber(100.0 * value, 3);
  };
  return mass.what + ", " + (estimate->value > 0.0 ? "+" : "") +
         percent(estimate->value) + " (" + percent(estimate->lower95) + " to " +
         percent(estimate->upper95) + ") %";
}

}  // namespace

std::string MassInstead(const IdentificationProblem& problem,
                        const IdentificationOptions& options,
                        const IdentifiedModel& model,
                        const std::vector<std::string>& groups,
                        const std::vector<GroupState>& healthy,
                        const std::map<std::string, double>& changed,
                        InnerFit* inner) {
  Comparison comparison(problem, options, model, inner);
  FitSummary fit;
  const double of_changes = comparison.Cost(
      KeptGroups(groups, healthy, changed), changed, nullptr, &fit);
  const std::vector<Kept> all = KeptGroups(groups, healthy, {});
  std::map<std::string, double> kept;
  for (const Kept& one : all) kept[one.name] = one.mean;
  double best = of_changes + limits::kLogOdds;
  std::string result;
  for (const Suspect& suspect : MakeSuspects(problem, model)) {
    if (suspect.kind != Suspect::Kind::kMass || suspect.groups.size() != 1) {
      continue;
    }
    // From where all groups are free, and from the healthy values.
    for (const auto& begin : {std::map<std::string, double>(), kept}) {
      const double cost = comparison.Cost(all, begin, &suspect, &fit);
      if (!(cost < best)) continue;
      best = cost;
      result = Describe(suspect, fit);
    }
  }
  return result;
}

}  // namespace pinode
