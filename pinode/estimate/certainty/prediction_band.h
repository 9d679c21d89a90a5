// How far a measurement may be from its prediction.

#ifndef PINODE_ESTIMATE_CERTAINTY_PREDICTION_BAND_H_
#define PINODE_ESTIMATE_CERTAINTY_PREDICTION_BAND_H_

#include "pinode/base/types.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Standard deviations of what the channels of a record read, channels x
// samples, about the free run `score`: that of the noise (`sigmas`, one a
// channel), that of the parameters (`covariance` of all free ones, by the
// linearised run) and, where the start is free, that of the start given the
// parameters, as the samples before score.first_scored_sample (of a training
// record, all) determine it. Gaussian; what the model cannot do is in it as far
// as it counts as noise.
//
// Empty where the run is not finite, or there are more than some ten million
// derivatives to be found.
Matrix PredictionDeviations(const IdentificationProblem& problem, int record,
                            const Vector& parameters, const Matrix& covariance,
                            const Vector& sigmas, const RecordScore& score,
                            int num_threads);

// Of the scored samples of a channel that were measured, the share within
// `quantile` deviations of the prediction; NaN where there are none.
double BandCoverage(const IdentificationRecord& record,
                    const RecordScore& score, int channel, double quantile);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_PREDICTION_BAND_H_
