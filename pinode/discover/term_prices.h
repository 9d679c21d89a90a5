// What a term of an equation must be worth.

#ifndef PINODE_DISCOVER_TERM_PRICES_H_
#define PINODE_DISCOVER_TERM_PRICES_H_

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "pinode/discover/discovery.h"

namespace pinode {

// What something with so many parameters must gain in twice the log-likelihood,
// by the extended BIC (J. Chen, Z. Chen, Biometrika 95 (2008) 759):
//
//   parameters * ln(number of fitted values) + 2 ln(alternatives).
double ExtendedBicPrice(Eigen::Index num_values, int num_parameters,
                        double num_alternatives);

// What terms must gain: of each the price of one parameter among
//
//   number of kinds * number of the kind
//
// alternatives.
//
// The second part is the price of having searched: of many candidates some fit
// the noise. All monomials of one degree are a kind, and all other functions.
// Each kind is as likely to hold a term as another, and so is each of its
// candidates, over all equations: of the few linear terms one is more likely
// than of the many cubic ones.
class TermPrices {
 public:
  TermPrices() = default;
  // `equations` have their candidates.
  TermPrices(Eigen::Index num_values,
             const std::vector<DiscoveredEquation>& equations);

  // 0 for a given term; ln(number of fitted values) for one that is no
  // candidate.
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
