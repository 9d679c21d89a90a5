// Uncertainty bands of predicted measurements.

#ifndef PINODE_ESTIMATE_CERTAINTY_PREDICTION_BAND_H_
#define PINODE_ESTIMATE_CERTAINTY_PREDICTION_BAND_H_

#include "pinode/base/types.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Returns standard deviations of the measured values of a record's channels
// about the simulation `score`, channels x samples. They combine:
//
// - the noise (`sigmas`, one per channel);
// - the parameters (`covariance` of all free ones, by the linearised run);
// - for a free start, the start given the parameters, as determined by the
//   samples before score.first_scored_sample (in a training record, by all).
//
// The bands are Gaussian. Errors of the model are included as far as they count
// as noise.
//
// Empty if the run is not finite, or if more than some ten million derivatives
// would be needed.
Matrix PredictionDeviations(const IdentificationProblem& problem, int record,
                            const Vector& parameters, const Matrix& covariance,
                            const Vector& sigmas, const RecordScore& score,
                            int num_threads);

// Returns the share of a channel's scored and measured samples within
// `quantile` deviations of the prediction; NaN if there are none.
double BandCoverage(const IdentificationRecord& record,
                    const RecordScore& score, int channel, double quantile);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_PREDICTION_BAND_H_
