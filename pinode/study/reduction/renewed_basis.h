// Reductions of finite-element models whose basis follows the parameters.

#ifndef PINODE_STUDY_REDUCTION_RENEWED_BASIS_H_
#define PINODE_STUDY_REDUCTION_RENEWED_BASIS_H_

#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/problem/inner_fit.h"
#include "pinode/study/reduction/reduced_structure.h"

namespace pinode {

// A problem of which the model is a reduced structure.
struct ReducedProblem {
  IdentificationProblem problem;
  ReducedStructure structure;
};

// The groups of mass and stiffness that the basis follows, with their values in
// `model`, one of the problem.
std::vector<GroupAtBasis> GroupsOfBasis(const ReducedProblem& from,
                                        const IdentifiedModel& model);

// The problem with the basis of its reduction taken from M and K with the
// groups at their values in `model`, and damping in proportion to these; *begin
// is `model` for it. Groups mean what they meant: shares of the exported
// matrices, and the problem is known as what it was (ProblemIdentity). Steps
// that were chosen are chosen again. False, with *error, where
// the model has no modes there, or problem, structure and model do not fit
// together.
[[nodiscard]] bool RenewBasis(const ReducedProblem& from,
                              const IdentifiedModel& model,
                              ReducedProblem* renewed, IdentifiedModel* begin,
                              std::string* error);

// Renews the basis after a sound fit of *from and fits again, with `options`
// and from the end of the last fit, until no group of mass or stiffness moves
// by more than 0.3 of its standard error, at most five times. *from, *summary
// and *model become those of the last fit. A remark of the problem's
// description says how often, and what is left. If a fit is interrupted, they
// stay as they were, but for the termination.
void RenewBasisUntilSettled(const IdentificationOptions& options, InnerFit* fit,
                            ReducedProblem* from, FitSummary* summary,
                            IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_STUDY_REDUCTION_RENEWED_BASIS_H_
