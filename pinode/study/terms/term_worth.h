// Worth of a discovered equation's term on the trajectories.

#ifndef PINODE_STUDY_TERMS_TERM_WORTH_H_
#define PINODE_STUDY_TERMS_TERM_WORTH_H_

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/discover/term_prices.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// True if `basis` is among the equation's terms.
bool HasTerm(const DiscoveredEquation& equation, const std::string& basis);

int CountTerms(const std::vector<DiscoveredEquation>& equations);

// Returns the parameter of that name; nullptr if there is none.
const ParameterEstimate* FindEstimate(const FitSummary& summary,
                                      const std::string& name);

// Returns the number of fitted values in the training records.
Eigen::Index NumFittedValues(const IdentificationProblem& problem);

// Returns twice the negative log-likelihood of the training records, without
// terms that do not depend on the model:
//
//   sum_c n_c RMSE_c^2 / sigma_c^2,  or  n_c ln RMSE_c^2
//
// if the noise of channel c is to be estimated. `summary` is of a fit of
// `problem`.
double Deviance(const IdentificationProblem& problem,
                const FitSummary& summary);

// Copies the fitted coefficients and shares into *equations.
void TakeOver(const FitSummary& summary,
              std::vector<DiscoveredEquation>* equations);

// Removes the least valuable term: one with a share below prune_fraction of the
// tolerance, with a coefficient at the bound that its sign sets, or with
// (xi / sigma_xi)^2 below its price. Returns false if all are worth their
// price.
bool DropWeakest(const DiscoveryOptions& options, const FitSummary& summary,
                 const TermPrices& prices,
                 std::vector<DiscoveredEquation>* equations);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_TERM_WORTH_H_
