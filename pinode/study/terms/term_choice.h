// Which of the candidates in a problem its training records support.

#ifndef PINODE_STUDY_TERMS_TERM_CHOICE_H_
#define PINODE_STUDY_TERMS_TERM_CHOICE_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/problem/checkpoint.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/terms/model_candidate.h"

namespace pinode {

// A problem with what came out of its fit.
struct TermFit {
  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
};

struct TermChoiceOptions {
  // Of the last fit; those on the way are of training records alone, and looser
  // (DecideQuickly).
  IdentificationOptions identification;
  // What runs the fits; empty: Identify.
  FitFunction fit;
  // Called after each step with what the choice can go on from: a model of what
  // is left, with noise and starts of the training records.
  std::function<void(const Checkpoint& checkpoint)> on_choice;
};

// Elimination by the extended BIC of the training records,
//
//   deviance / memory + sum over the candidates in the model of
//   (p ln(number of fitted values) + 2 ln(number of candidates)),
//
// p the number of a candidate's free unknowns, the deviance that of
// term_worth.h with the modal residuals, and the memory of the residuals
// (FittedCost) that of the fit with all candidates. First the terms of
// libraries that the cost near the fit does not ask for (SupportNearFit) are
// left out together. Then the candidate with the smallest Wald value xi'
// cov(xi)^-1 xi of its amplitudes is left out, and the next, each once:
// elements, and terms of libraries where a fit did not confirm what the cost
// promised. At the end the terms of libraries that the cost asks for now are
// taken in again. After each of these everything else is fitted from where it
// was, and what makes the criterion smaller stays.
//
// *fit: a fit of `all` without fit->summary.choice.left_out (which is empty, or
// of a choice that was cut off); then the fit of what is left, its
// summary.choice, and a remark that says it. Where a fit is interrupted, what
// was left then, with a termination that says so. False, with *error and *fit
// untouched, where candidates or fit do not fit the problem or what is left
// cannot be fitted.
[[nodiscard]] bool ChooseTerms(const IdentificationProblem& all,
                               const std::vector<ModelCandidate>& candidates,
                               const TermChoiceOptions& options, TermFit* fit,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_TERM_CHOICE_H_
