// How much noise the sensors of a hold-out record have.

#ifndef PINODE_ESTIMATE_CERTAINTY_HOLDOUT_NOISE_H_
#define PINODE_ESTIMATE_CERTAINTY_HOLDOUT_NOISE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// A sensor may be noisier in one record than in another: where amplifiers have
// ranges, where noise grows with the motion. What the samples of a channel have
// beyond the frequencies of the motion says so without the model,
//
//   w = mean square of the samples' differences of eighth order / C(16, 8),
//
// which is the variance of white noise, while next to nothing is left of what
// is below a third of the sampling rate. So the variance of a sensor's noise
// in a hold-out is that of the training record, which has what the model cannot
// do in it, plus the difference of their w; where
//
//   - the hold-out's noise is not given, and the sensor was fitted in training,
//   - of both records' predictions w is less than a twentieth of that of what
//     was measured: there is no motion at these frequencies,
//   - the two w differ by more than two standard deviations of the difference.
//
// Elsewhere the noise of the training record is all that is known. It is for
// bands alone: no start and no choice may know a hold-out.
//
// `sigmas`: of all records, a number a channel, as NoiseOfAllRecords has them;
// `scores`: free runs of all records. Returns those of `record`.
Vector HoldoutNoise(const IdentificationProblem& problem, int record,
                    const std::vector<Vector>& sigmas,
                    const std::vector<RecordScore>& scores);

// What HoldoutNoise has found, in a sentence: `own` of `record` beside the
// noise of training. Nothing where they are the same.
std::string HoldoutNoiseRemark(const IdentificationRecord& record,
                               const Vector& training, const Vector& own);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_HOLDOUT_NOISE_H_
