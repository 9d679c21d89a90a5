// Sentences about a fit, for those who were not there.

#ifndef PINODE_REPORT_FIT_TEXT_H_
#define PINODE_REPORT_FIT_TEXT_H_

#include <string>
#include <utility>
#include <vector>

#include "pinode/problem/identification_summary.h"

namespace pinode {

// What IdentificationSummary::covariance_method means.
std::string CovarianceSentence(const std::string& method);

// How the fit was solved: names and texts, in the order of the page.
std::vector<std::pair<std::string, std::string>> SolutionFacts(
    const IdentificationSummary& summary);

// What the data do not say: directions, bounds, pairs of parameters that they
// hardly tell apart.
std::vector<std::string> Limits(const IdentificationSummary& summary);

// What there is to say where there are none; empty where Limits says it.
std::string NoLimitsSentence(const IdentificationSummary& summary);

}  // namespace pinode

#endif  // PINODE_REPORT_FIT_TEXT_H_
