// Terms of discovered equations before and after a refit.

#ifndef PINODE_STUDY_LAWS_DISCOVERED_TERMS_H_
#define PINODE_STUDY_LAWS_DISCOVERED_TERMS_H_

#include <string>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Returns the terms in `a` that are not in `b`, such as "u1: x[u1]^2". Both
// have the same outputs.
std::vector<std::string> Difference(const std::vector<DiscoveredEquation>& a,
                                    const std::vector<DiscoveredEquation>& b);

bool SameTerms(const std::vector<DiscoveredEquation>& a,
               const std::vector<DiscoveredEquation>& b);

// Enters units, the coefficients of `selected`, which are those before the
// refit, and the intervals of the refit. nullptr for `summary`: no refit.
void CompleteTerms(const IdentificationProblem& problem,
                   const std::vector<DiscoveredEquation>& selected,
                   const FitSummary* summary,
                   std::vector<DiscoveredEquation>* equations);

}  // namespace pinode

#endif  // PINODE_STUDY_LAWS_DISCOVERED_TERMS_H_
