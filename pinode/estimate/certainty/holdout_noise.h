// Noise of the sensors in a hold-out record.

#ifndef PINODE_ESTIMATE_CERTAINTY_HOLDOUT_NOISE_H_
#define PINODE_ESTIMATE_CERTAINTY_HOLDOUT_NOISE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/assumed_noise.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Estimates the noise of a hold-out record's sensors. A sensor may be noisier
// in one record than in another: amplifiers have ranges, and noise may grow
// with the motion. The samples' content beyond the frequencies of the motion
// gives the noise without the model,
//
//   w = mean square of the samples' differences of eighth order / C(16, 8),
//
// which is the variance of white noise. Frequencies below a third of the
// sampling rate contribute almost nothing. The variance of a sensor's noise in
// a hold-out is then that of the training record, which includes the model's
// error, plus the difference of their w. This is used if
//
// - the hold-out's noise is not given, and the sensor was fitted in training,
// - w of both records' predictions is less than a twentieth of that of the
//   measurements: there is no motion at these frequencies,
// - the two w differ by more than two standard deviations of the difference.
//
// Otherwise the noise of the training record is used. The result is for bands
// alone: no start and no choice may depend on a hold-out.
//
// `sigmas`: of all records, one number per channel, as from NoiseOfAllRecords.
// `scores`: simulations of all records. Returns the sigmas of `record`.
Vector HoldoutNoise(const IdentificationProblem& problem,
                    const TrainedSensors& trained, int record,
                    const std::vector<Vector>& sigmas,
                    const std::vector<RecordScore>& scores);

// Returns a sentence on the result of HoldoutNoise: `own` of `record` compared
// with the noise of training. Empty if they are the same.
std::string HoldoutNoiseRemark(const IdentificationRecord& record,
                               const Vector& training, const Vector& own);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_HOLDOUT_NOISE_H_
