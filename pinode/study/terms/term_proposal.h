// The terms that the residuals of trajectories ask for.

#ifndef PINODE_STUDY_TERMS_TERM_PROPOSAL_H_
#define PINODE_STUDY_TERMS_TERM_PROPOSAL_H_

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/discover/stepwise.h"
#include "pinode/discover/term_prices.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// The entries that SelectStepwise asks for where `around` is the cost near a
// fit, its samples fewer by `memory`; `from_zero` is the fit's value of each
// entry that counts from 0, and 0 of those that count from where they are.
std::vector<int> SupportNearFit(const FittedCost& around, double memory,
                                const Vector& from_zero,
                                const StepwiseOptions& options,
                                const std::vector<int>& start);

// Candidates that are no terms yet with a coefficient of 0.
std::vector<DiscoveredEquation> WithAllCandidates(
    std::vector<DiscoveredEquation> equations);

// Where a search for terms begins: a fit with some of them.
struct FittedEquations {
  const IdentificationProblem& problem;  // that has them
  const std::vector<RecordScore>& records;
  const IdentifiedModel& model;
  const std::vector<int>& substeps;  // of each record
  const std::vector<DiscoveredEquation>& equations;
};

// The terms that the cost, quadratic near the fit in the coefficients of all
// candidates, asks for (SelectStepwise, with these prices); new ones with a
// coefficient of 0. *memory: by how much the samples are fewer than they look.
// *equations are as they were where the trajectories are not finite. False,
// with *error, where the candidates do not fit the problem.
[[nodiscard]] bool ProposeTerms(const FittedEquations& fitted,
                                const DiscoveryOptions& options,
                                const TermPrices& prices, int num_threads,
                                std::vector<DiscoveredEquation>* equations,
                                double* memory, std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_TERM_PROPOSAL_H_
