#include "pinode/study/terms/term_proposal.h"

#include <algorithm>
#include <map>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/terms/discovered_problem.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

// Returns the positions of the free parameters by name.
std::map<std::string, int> FreeEntries(const ParameterLayout& layout) {
  std::map<std::string, int> entries;
  for (const int i : layout.free()) {
    entries[layout.parameter(i).name] = layout.FreeIndex(i);
  }
  return entries;
}

QuadraticCost CostFromZero(const FittedCost& around, double memory,
                           const Vector& from_zero) {
  QuadraticCost cost;
  cost.hessian = around.system.hessian / memory;
  cost.gradient = around.system.gradient / memory;
  cost.gradient -= cost.hessian * from_zero;
  return cost;
}

}  // namespace

std::vector<int> SupportNearFit(const FittedCost& around, double memory,
                                const Vector& from_zero,
                                const StepwiseOptions& options,
                                const std::vector<int>& start) {
  return SelectStepwise(CostFromZero(around, memory, from_zero), options,
                        start);
}

std::vector<DiscoveredEquation> WithAllCandidates(
    std::vector<DiscoveredEquation> equations) {
  for (DiscoveredEquation& equation : equations) {
    for (const DiscoveryCandidate& candidate : equation.candidates) {
      if (HasTerm(equation, candidate.basis)) continue;
      DiscoveredTerm term;
      term.basis = candidate.basis;
      term.basis_rms = candidate.rms;
      term.sign = candidate.sign;
      term.inclusion_probability = kNaN;
      equation.terms.push_back(std::move(term));
    }
  }
  return equations;
}

OfferedCost MakeOfferedCost(const TermOffer& offer,
                            const ParameterLayout& layout, const Vector& free,
                            const FittedCost& around) {
  const std::map<std::string, int> entries = FreeEntries(layout);
  const std::vector<DiscoveredEquation>& wide = offer.wide;
  const DiscoveryOptions& discovery = offer.options;
  OfferedCost offered;
  StepwiseOptions& options = offered.options;
  const size_t size = static_cast<size_t>(free.size());
  options.prices = Vector::Zero(free.size());
  options.optional.assign(size, false);
  options.signs.assign(size, 0);
  options.smallest = Vector::Zero(free.size());
  offered.from_zero = Vector::Zero(free.size());
  for (size_t e = 0; e < wide.size(); ++e) {
    for (const DiscoveredTerm& term : wide[e].terms) {
      const auto found = entries.find(CoefficientName(wide[e], term.basis));
      if (term.given || found == entries.end()) continue;
      const int j = found->second;
      offered.from_zero[j] = free[j];
      options.prices[j] = offer.prices.Of(wide[e], term);
      options.optional[static_cast<size_t>(j)] = true;
      options.signs[static_cast<size_t>(j)] = term.sign;
      options.smallest[j] = discovery.prune_fraction * discovery.tolerance *
                            wide[e].scale / std::max(term.basis_rms, 1e-300);
      if (HasTerm(offer.present[e], term.basis)) offered.start.push_back(j);
    }
  }
  offered.cost = CostFromZero(around, around.memory, offered.from_zero);
  return offered;
}

std::vector<DiscoveredEquation> EquationsOn(
    const std::vector<DiscoveredEquation>& wide, const ParameterLayout& layout,
    const QuadraticCost& cost, const std::vector<int>& support) {
  const std::map<std::string, int> entries = FreeEntries(layout);
  const Vector values = MinimizeOn(cost, support);
  std::vector<DiscoveredEquation> chosen = wide;
  for (DiscoveredEquation& equation : chosen) {
    std::vector<DiscoveredTerm> terms;
    for (DiscoveredTerm& term : equation.terms) {
      const auto found = entries.find(CoefficientName(equation, term.basis));
      if (term.given) {
        terms.push_back(std::move(term));
      } else if (found != entries.end() &&
                 std::binary_search(support.begin(), support.end(),
                                    found->second)) {
        term.coefficient = values[found->second];
        terms.push_back(std::move(term));
      }
    }
    equation.terms = std::move(terms);
  }
  return chosen;
}

void ChooseTerms(const TermOffer& offer, const ParameterLayout& layout,
                 const Vector& free, const FittedCost& around,
                 std::vector<DiscoveredEquation>* equations) {
  const OfferedCost offered = MakeOfferedCost(offer, layout, free, around);
  *equations =
      EquationsOn(offer.wide, layout, offered.cost,
                  SelectStepwise(offered.cost, offered.options, offered.start));
}

bool MakeCandidateCost(const FittedEquations& fitted, int num_threads,
                       CandidateCost* cost, std::string* error) {
  cost->wide = WithAllCandidates(fitted.equations);
  if (!MakeDiscoveredProblem(fitted.problem, fitted.model, cost->wide,
                             fitted.substeps, &cost->problem, &cost->model,
                             error)) {
    return false;
  }
  cost->model.decays = fitted.model.decays;
  cost->finite =
      LinearizeAtFit(cost->problem, ParameterLayout(cost->problem), cost->model,
                     fitted.records, num_threads, &cost->around);
  return true;
}

bool ProposeTerms(const FittedEquations& fitted,
                  const DiscoveryOptions& options, const TermPrices& prices,
                  int num_threads, std::vector<DiscoveredEquation>* equations,
                  double* memory, std::string* error) {
  CandidateCost cost;
  if (!MakeCandidateCost(fitted, num_threads, &cost, error)) return false;
  if (!cost.finite) return true;
  *memory = cost.around.memory;
  const ParameterLayout layout(cost.problem);
  ChooseTerms({cost.wide, fitted.equations, options, prices}, layout,
              layout.Free(cost.model.parameters), cost.around, equations);
  // A fit from the present values follows.
  for (size_t e = 0; e < cost.wide.size(); ++e) {
    for (DiscoveredTerm& term : (*equations)[e].terms) {
      for (const DiscoveredTerm& before : cost.wide[e].terms) {
        if (before.basis == term.basis) term.coefficient = before.coefficient;
      }
    }
  }
  return true;
}

}  // namespace pinode
