// Other sets of terms that describe the records about as well as the chosen
// ones, and the probability of each term that follows.

#ifndef PINODE_STUDY_LAWS_TERM_RIVALS_H_
#define PINODE_STUDY_LAWS_TERM_RIVALS_H_

#include <limits>
#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/discover/term_prices.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/verdict.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

// A fit that is compared with its rivals.
struct RivalInput {
  const IdentificationProblem& before;  // without equations, for the deviance
  const IdentificationProblem& problem;
  const FitSummary& summary;
  const IdentifiedModel& model;
  const std::vector<int>& substeps;  // of each record
  const std::vector<DiscoveredEquation>& equations;
};

// Result of the comparison.
struct RivalComparison {
  // True: a fit was interrupted, and nothing was compared.
  bool interrupted = false;
  // The rivals that lack a chosen term, most likely first, with odds of at
  // least 1 to 100.
  std::vector<TermRival> rivals;
  // Probability that there are terms beside the chosen ones. NaN: not compared.
  double incomplete = std::numeric_limits<double>::quiet_NaN();
  double memory = 1.0;  // autocorrelation time of the residuals
  // Rival that is better, from which a fit begins; empty: none.
  std::vector<DiscoveredEquation> better;
  IdentifiedModel better_model;  // of the problem that `better_problem` is
  IdentificationProblem better_problem;
};

// Compares a fit with other sets of terms:
//
// 1. The cost near the fit, quadratic in the coefficients of all candidates,
//    gives the sets whose probability is at least 1e-3 times that of the best
//    one (SupportsWithin, with TermPrices::AtRatesOf).
// 2. The best of those that lack a chosen term are fitted to the trajectories.
//    Their deviance then takes the place of the predicted one.
// 3. The probability of a term is the weight of the sets that hold it, as a
//    fraction of the weight of all sets (Bayesian model averaging: J. A.
//    Hoeting et al. 1999). It is entered into *equations, for candidates too.
//
// `prices` are those of the search: a rival is better if it lowers the
// criterion with them. Returns false, with *error, if the candidates do not fit
// the problem. *equations have no probabilities if nothing was compared: the
// cost is not finite, or a fit was interrupted.
[[nodiscard]] bool CompareWithRivals(
    const RivalInput& input, const DiscoveryOptions& options,
    const TermPrices& prices, const IdentificationOptions& identification,
    InnerFit* inner, std::vector<DiscoveredEquation>* equations,
    RivalComparison* comparison, std::string* error);

// Returns a finding if a chosen term is uncertain, which names the terms and
// their rivals, and one if a candidate that was left out is probably a term.
// The latter comes too if `incomplete`, the probability that there are more
// terms, exceeds 40 %. If `searched`, a term without a probability is uncertain
// too.
std::vector<Finding> CheckTerms(
    const std::vector<DiscoveredEquation>& equations,
    const std::vector<TermRival>& rivals, double incomplete, bool searched);

}  // namespace pinode

#endif  // PINODE_STUDY_LAWS_TERM_RIVALS_H_
