// Which of the candidates in a problem its training records support.

#ifndef PINODE_STUDY_TERMS_TERM_CHOICE_H_
#define PINODE_STUDY_TERMS_TERM_CHOICE_H_

#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/problem/checkpoint.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/problem/inner_fit.h"
#include "pinode/study/terms/model_candidate.h"

namespace pinode {

// A problem with what came out of its fit.
// A fit with the terms that are left.
struct TermFit {
  IdentificationProblem problem;
  FitSummary summary;
  IdentifiedModel model;
  // Candidates that were left out so far. Empty: the choice has not begun.
  ModelChoice choice;
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
// `options` are those of the last fit. The fits on the way use the training
// records alone and are looser (DecideQuickly). The watch of `inner` hears of
// each step (OnChoice).
//
// *fit: before, a fit of `all` without fit->choice.left_out, which is empty or
// that of an interrupted choice; after, the fit of the terms that are left, and
// its choice. If a fit is interrupted, *fit is what was left then, with a
// termination that says so. False, with *error and *fit untouched, if
// candidates or fit do not fit the problem, or if the terms that are left
// cannot be fitted.
[[nodiscard]] bool ChooseTerms(const IdentificationProblem& all,
                               const std::vector<ModelCandidate>& candidates,
                               const IdentificationOptions& options,
                               InnerFit* inner, TermFit* fit,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_TERM_CHOICE_H_
