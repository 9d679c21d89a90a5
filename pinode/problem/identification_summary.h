// Results of an identification.

#ifndef PINODE_PROBLEM_IDENTIFICATION_SUMMARY_H_
#define PINODE_PROBLEM_IDENTIFICATION_SUMMARY_H_

#include <string>
#include <utility>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/model_choice.h"
#include "pinode/problem/parameter_profile.h"
#include "pinode/problem/verdict.h"

namespace pinode {

// Outcome of Identify: its last fit, judged. A summary starts as not usable.
struct IdentificationSummary : FitSummary {
  IdentificationSummary() = default;
  explicit IdentificationSummary(FitSummary fit) : FitSummary(std::move(fit)) {}

  // Verdict and the findings it follows from.
  Verdict verdict;
  bool usable() const { return verdict.usable(); }

  // Refits with more unknowns that describe the records better than the model
  // as it is, best first (study/explanations/explain.h).
  std::vector<Explanation> explanations;

  // Choice among candidate terms (study/terms/term_choice.h). Empty: the
  // problem had no candidates.
  ModelChoice choice;
  // Profiles of the likelihood, where the case asks for them
  // (estimate/certainty/profile.h).
  std::vector<ParameterProfile> profiles;
  double profile_seconds = 0.0;

  // Verdict, message, iterations and gaps in one line, the parameters below.
  std::string BriefReport() const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_IDENTIFICATION_SUMMARY_H_
