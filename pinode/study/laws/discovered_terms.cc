#include "pinode/study/laws/discovered_terms.h"

#include "pinode/base/constants.h"
#include "pinode/study/terms/discovered_problem.h"
#include "pinode/study/terms/library_term.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {

std::vector<std::string> Difference(const std::vector<DiscoveredEquation>& a,
                                    const std::vector<DiscoveredEquation>& b) {
  std::vector<std::string> result;
  for (size_t e = 0; e < a.size(); ++e) {
    for (const DiscoveredTerm& term : a[e].terms) {
      if (!HasTerm(b[e], term.basis)) {
        result.push_back(a[e].output + ": " + term.basis);
      }
    }
  }
  return result;
}

bool SameTerms(const std::vector<DiscoveredEquation>& a,
               const std::vector<DiscoveredEquation>& b) {
  return Difference(a, b).empty() && Difference(b, a).empty();
}

void CompleteTerms(const IdentificationProblem& problem,
                   const std::vector<DiscoveredEquation>& selected,
                   const FitSummary* summary,
                   std::vector<DiscoveredEquation>* equations) {
  for (size_t e = 0; e < equations->size(); ++e) {
    DiscoveredEquation& equation = (*equations)[e];
    for (DiscoveredTerm& term : equation.terms) {
      term.unit =
          LibraryCoefficientUnit(BasisFunction(equation, term.basis),
                                 equation.features, problem.dynamics->inputs(),
                                 equation.acts_as, problem.description.units);
      term.regressed = 0.0;
      for (const DiscoveredTerm& before : selected[e].terms) {
        if (before.basis == term.basis) term.regressed = before.coefficient;
      }
      term.sigma = term.lower95 = term.upper95 = kNaN;
      const ParameterEstimate* estimate =
          summary == nullptr
              ? nullptr
              : FindEstimate(*summary, CoefficientName(equation, term.basis));
      if (estimate != nullptr) {
        term.sigma = estimate->sigma;
        term.lower95 = estimate->lower95;
        term.upper95 = estimate->upper95;
      }
    }
  }
}

}  // namespace pinode
