// Terms that the residuals of trajectories ask for.

#ifndef PINODE_STUDY_TERMS_TERM_PROPOSAL_H_
#define PINODE_STUDY_TERMS_TERM_PROPOSAL_H_

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/discover/quadratic_face.h"
#include "pinode/discover/stepwise.h"
#include "pinode/discover/term_prices.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Returns the entries that SelectStepwise chooses if `around` is the cost near
// a fit, with `memory` samples per independent one. `from_zero`: the fit's
// value of each entry that counts from 0, and 0 for entries that count from
// their fitted value.
std::vector<int> SupportNearFit(const FittedCost& around, double memory,
                                const Vector& from_zero,
                                const StepwiseOptions& options,
                                const std::vector<int>& start);

// Returns the equations with a coefficient of 0 for candidates that are no
// terms yet.
std::vector<DiscoveredEquation> WithAllCandidates(
    std::vector<DiscoveredEquation> equations);

// Candidates that may become terms, and what they cost.
struct TermOffer {
  const std::vector<DiscoveredEquation>& wide;     // with all candidates
  const std::vector<DiscoveredEquation>& present;  // the choice begins here
  const DiscoveryOptions& options;
  const TermPrices& prices;
};

// Input of SelectStepwise for an offer. Coefficients of candidates may be left
// out and count from 0. All other unknowns stay and count from their value.
struct OfferedCost {
  QuadraticCost cost;
  StepwiseOptions options;
  Vector from_zero;        // value at the expansion of each entry from 0, or 0
  std::vector<int> start;  // entries of the present terms
};

// Makes the input of SelectStepwise for a cost that is quadratic about the free
// parameters `free` of a problem with all candidates.
OfferedCost MakeOfferedCost(const TermOffer& offer,
                            const ParameterLayout& layout, const Vector& free,
                            const FittedCost& around);

// Returns `wide` with the terms in `support`, ascending. Their coefficients are
// the minimum of the cost.
std::vector<DiscoveredEquation> EquationsOn(
    const std::vector<DiscoveredEquation>& wide, const ParameterLayout& layout,
    const QuadraticCost& cost, const std::vector<int>& support);

// Chooses terms by SelectStepwise for a cost that is quadratic about the free
// parameters `free` of a problem with all candidates. The coefficients are the
// minimum of this cost.
void ChooseTerms(const TermOffer& offer, const ParameterLayout& layout,
                 const Vector& free, const FittedCost& around,
                 std::vector<DiscoveredEquation>* equations);

// Start of a search for terms: a fit with some of them.
struct FittedEquations {
  const IdentificationProblem& problem;  // that has them
  const std::vector<RecordScore>& records;
  const IdentifiedModel& model;
  const std::vector<int>& substeps;  // of each record
  const std::vector<DiscoveredEquation>& equations;
};

// The cost near a fit, with all candidates in the equation of motion. Those
// that are no terms have coefficients of 0.
struct CandidateCost {
  std::vector<DiscoveredEquation> wide;  // with all candidates
  IdentificationProblem problem;         // with all candidates
  IdentifiedModel model;                 // at which the cost is expanded
  FittedCost around;
  bool finite = false;  // false: `around` has no meaning
};

// Returns false, with *error, if the candidates do not fit the problem.
[[nodiscard]] bool MakeCandidateCost(const FittedEquations& fitted,
                                     int num_threads, CandidateCost* cost,
                                     std::string* error);

// Proposes the terms chosen by SelectStepwise with these prices, for the cost
// that is quadratic near the fit in the coefficients of all candidates. New
// terms have a coefficient of 0. *memory: samples per independent one.
// *equations are unchanged if the trajectories are not finite. Returns false,
// with *error, if the candidates do not fit the problem.
[[nodiscard]] bool ProposeTerms(const FittedEquations& fitted,
                                const DiscoveryOptions& options,
                                const TermPrices& prices, int num_threads,
                                std::vector<DiscoveredEquation>* equations,
                                double* memory, std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_TERM_PROPOSAL_H_
