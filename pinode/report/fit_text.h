// Sentences about a fit for readers who did not run it.

#ifndef PINODE_REPORT_FIT_TEXT_H_
#define PINODE_REPORT_FIT_TEXT_H_

#include <string>
#include <utility>
#include <vector>

#include "pinode/problem/identification_summary.h"

namespace pinode {

// Explains IdentificationSummary::covariance_method.
std::string CovarianceSentence(const std::string& method);

// Returns facts on the solution of the fit: names and texts, in the order of
// the page.
std::vector<std::pair<std::string, std::string>> SolutionFacts(
    const IdentificationSummary& summary);

// Returns the limits of the data: undetermined directions, bounds, and pairs of
// parameters that they hardly distinguish.
std::vector<std::string> Limits(const IdentificationSummary& summary);

// Returns a sentence for a fit without limits; empty if there are Limits.
std::string NoLimitsSentence(const IdentificationSummary& summary);

}  // namespace pinode

#endif  // PINODE_REPORT_FIT_TEXT_H_
