#include "pinode/discover/term_prices.h"

#include <algorithm>
#include <cmath>

namespace pinode {

double ExtendedBicPrice(Eigen::Index num_values, int num_parameters,
                        double num_alternatives) {
  return num_parameters * std::log(static_cast<double>(
                              std::max<Eigen::Index>(num_values, 3))) +
         2.0 * std::log(num_alternatives);
}

TermPrices::TermPrices(Eigen::Index num_values,
                       const std::vector<DiscoveredEquation>& equations)
    : of_a_parameter_(ExtendedBicPrice(num_values, 1, 1.0)) {
  std::map<int, int> kinds;
  for (const DiscoveredEquation& equation : equations) {
    for (const DiscoveryCandidate& candidate : equation.candidates) {
      ++kinds[candidate.degree];
    }
  }
  const double num_kinds = static_cast<double>(kinds.size());
  for (const DiscoveredEquation& equation : equations) {
    for (const DiscoveryCandidate& candidate : equation.candidates) {
      prices_[KeyOf(equation, candidate.basis)] =
          ExtendedBicPrice(num_values, 1, num_kinds * kinds[candidate.degree]);
    }
  }
}

TermPrices TermPrices::AtRatesOf(
    Eigen::Index num_values, const std::vector<DiscoveredEquation>& equations) {
  std::map<int, int> candidates;
  std::map<int, int> terms;
  for (const DiscoveredEquation& equation : equations) {
    for (const DiscoveryCandidate& candidate : equation.candidates) {
      ++candidates[candidate.degree];
      terms[candidate.degree] +=
          std::any_of(equation.terms.begin(), equation.terms.end(),
                      [&candidate](const DiscoveredTerm& term) {
                        return term.basis == candidate.basis;
                      });
    }
  }
  TermPrices prices;
  prices.of_a_parameter_ = ExtendedBicPrice(num_values, 1, 1.0);
  for (const DiscoveredEquation& equation : equations) {
    for (const DiscoveryCandidate& candidate : equation.candidates) {
      const double k = terms[candidate.degree];
      const double odds = (candidates[candidate.degree] - k + 1.0) / (k + 1.0);
      prices.prices_[KeyOf(equation, candidate.basis)] =
          std::max(0.0, ExtendedBicPrice(num_values, 1, odds));
    }
  }
  return prices;
}

double TermPrices::Of(const DiscoveredEquation& equation,
                      const DiscoveredTerm& term) const {
  if (term.given) return 0.0;
  const auto found = prices_.find(KeyOf(equation, term.basis));
  return found != prices_.end() ? found->second : of_a_parameter_;
}

double TermPrices::Sum(const std::vector<DiscoveredEquation>& equations) const {
  double sum = 0.0;
  for (const DiscoveredEquation& equation : equations) {
    for (const DiscoveredTerm& term : equation.terms) sum += Of(equation, term);
  }
  return sum;
}

}  // namespace pinode
