// A fit with its verdict, for tests of layers below the main job.

#ifndef PINODE_TESTS_SUPPORT_IDENTIFY_TESTING_H_
#define PINODE_TESTS_SUPPORT_IDENTIFY_TESTING_H_

#include <string>
#include <utility>
#include <vector>

#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/estimate/fit/fit_once.h"
#include "pinode/problem/identification_summary.h"

namespace pinode::testing {

// Verdicts of results that tests make up.
inline Verdict Good() { return Verdict(std::vector<Finding>{}); }
inline Verdict NotUsable(const std::string& what = "made up") {
  return Verdict(std::vector<Finding>{{"made_up", what}});
}

// Judges *summary by the checks of a fit alone, as Identify does after its last
// fit.
inline void JudgeFit(const GapTuning& gaps, IdentificationSummary* summary) {
  std::vector<Finding> findings = CheckFit(gaps, *summary);
  if (!findings.empty()) summary->message = findings.front().Sentence();
  summary->verdict = Verdict(std::move(findings));
}

// FitOnce, and JudgeFit.
inline void FitAndJudge(const IdentificationProblem& problem,
                        const IdentificationOptions& options,
                        const IdentifiedModel* initial,
                        IdentificationSummary* summary,
                        IdentifiedModel* model) {
  FitSummary fit;
  FitOnce(problem, options, initial, &fit, model);
  *summary = IdentificationSummary(std::move(fit));
  JudgeFit(options.tuning.gaps, summary);
}

}  // namespace pinode::testing

#endif  // PINODE_TESTS_SUPPORT_IDENTIFY_TESTING_H_
