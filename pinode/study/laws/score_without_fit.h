// Scores of a model as it is.

#ifndef PINODE_STUDY_LAWS_SCORE_WITHOUT_FIT_H_
#define PINODE_STUDY_LAWS_SCORE_WITHOUT_FIT_H_

#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Computes free runs of the training records without a fit. They begin at the
// starts in *model. A start that is missing there is estimated from the first
// samples. The noise in *model becomes that of the residuals without a memory,
// unless it is given. Returns false if a run is not finite.
[[nodiscard]] bool ScoreWithoutFit(const IdentificationProblem& problem,
                                   IdentifiedModel* model,
                                   std::vector<RecordScore>* scores);

}  // namespace pinode

#endif  // PINODE_STUDY_LAWS_SCORE_WITHOUT_FIT_H_
