// Price that a term of an equation must be worth.

#ifndef PINODE_DISCOVER_TERM_PRICES_H_
#define PINODE_DISCOVER_TERM_PRICES_H_

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "pinode/discover/discovery.h"

namespace pinode {

// Returns the gain in twice the log-likelihood that justifies so many
// parameters, by the extended BIC (J. Chen, Z. Chen, Biometrika 95 (2008) 759):
//
//   parameters * ln(number of fitted values) + 2 ln(alternatives).
double ExtendedBicPrice(Eigen::Index num_values, int num_parameters,
                        double num_alternatives);

// Prices of terms: each is the price of one parameter among
//
//   number of kinds * number of the kind
//
// alternatives.
//
// The second part is the price of the search: among many candidates some fit
// the noise. All monomials of one degree are one kind, all other functions
// another. Each kind is equally likely to contain a term, and so is each of its
// candidates, over all equations. One of the few linear terms is therefore more
// likely than one of the many cubic ones.
class TermPrices {
 public:
  TermPrices() = default;
  // Computes the prices. `equations` must have their candidates.
  TermPrices(Eigen::Index num_values,
             const std::vector<DiscoveredEquation>& equations);

  // Computes prices at the rates at which the kinds have terms in `equations`,
  // of which the rule of succession is the estimate (P. S. Laplace 1774):
  //
  //   ln(number of fitted values) + 2 ln((p - k + 1) / (k + 1)),
  //
  // p candidates of the kind, k of them terms. The prices above keep false
  // terms out, and so favour the smaller of two equations. These prices favour
  // neither, and exp(-price / 2) are odds (J. G. Scott, J. O. Berger 2010).
  static TermPrices AtRatesOf(Eigen::Index num_values,
                              const std::vector<DiscoveredEquation>& equations);

  // Returns 0 for a given term, and ln(number of fitted values) for one that is
  // no candidate.
  double Of(const DiscoveredEquation& equation,
            const DiscoveredTerm& term) const;
  double Sum(const std::vector<DiscoveredEquation>& equations) const;

 private:
  using Key = std::tuple<std::string, std::string, std::string>;
  static Key KeyOf(const DiscoveredEquation& equation,
                   const std::string& basis) {
    return {equation.network, equation.output, basis};
  }

  double of_a_parameter_ = 0.0;
  std::map<Key, double> prices_;
};

}  // namespace pinode

#endif  // PINODE_DISCOVER_TERM_PRICES_H_
