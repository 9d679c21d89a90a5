// Comparison of measured frequency response functions with those of a model.

#ifndef PINODE_ESTIMATE_FRF_FRF_SCORE_H_
#define PINODE_ESTIMATE_FRF_FRF_SCORE_H_

#include "pinode/base/types.h"
#include "pinode/estimate/frf/frf_cost.h"
#include "pinode/problem/ambient_record.h"

namespace pinode {

// Returns the score of the model at `free`, without prior_errors. Returns false
// if the model has no FRFs there.
//
// The residuals of a right model are noise: white from line to line, and as
// large at resonances as elsewhere, relative to their variances. Two tests look
// at each pair: the Ljung-Box test of the real and of the imaginary part over
// 20 lags, and the sum of squares over the tenth of the lines where the FRF is
// largest relative to its deviation, against chi^2. `probability` is the least
// of all, times their number (Bonferroni).
[[nodiscard]] bool ScoreFrfs(const Vector& free, FrfCost* cost,
                             FrfScore* score);

// Returns the norm of the weighted error of each pair as a share of that of the
// FRF, at the last point of the cost.
Vector FrfErrors(const FrfCost& cost);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FRF_FRF_SCORE_H_
