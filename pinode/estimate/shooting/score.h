// Free runs over whole records and their errors.

#ifndef PINODE_ESTIMATE_SHOOTING_SCORE_H_
#define PINODE_ESTIMATE_SHOOTING_SCORE_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/integrate/free_run.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Runs the record from `start` and compares every channel with what was
// measured: sensors and filter applied. Fills *score but for its prior_nrmse.
// `parameters`: all of the problem's. A run that is not finite has infinite
// errors. The states of one that is are kept where `keep` says so; their mean
// squares where that is not kChannels.
void ScoreRecord(const IdentificationProblem& problem, int record,
                 const Vector& parameters, const Vector& start,
                 Eigen::Index first_scored_sample, RecordScore* score,
                 Keep keep = Keep::kAll, int num_threads = 1);

// Signals of some of the record's sensors, `channels`, in the run that
// ScoreRecord makes: channels.size() x samples, in their order. Empty where the
// run is not finite.
Matrix PredictChannels(const IdentificationProblem& problem, int record,
                       const std::vector<int>& channels,
                       const Vector& parameters, const Vector& start,
                       int num_threads = 1);

// Root mean square over the training records of their errors, each run freely
// from its first start in `shooting`; infinite where one is not finite, 0 where
// there is none. What the fit itself is judged by on the way. Where records are
// in one piece and just linearised at `free`, nothing is run.
double FreeRunError(const IdentificationProblem& problem,
                    const ParameterLayout& layout,
                    const MultipleShooting& shooting, const Vector& free);

// sqrt(mean over fitted channels of nrmse^2); infinite where not finite.
double CombinedError(const IdentificationRecord& record,
                     const RecordScore& score);

// Share of the residuals' energy over all channels that has no memory from
// sample to sample (ChannelScore::noise_share), 0 to 1; NaN where no channel
// tells.
double NoiseShareOf(const RecordScore& score);

// Unexplained motion of a record, RMS: the part of the error that has a memory
// from sample to sample and so is not noise. If the noise is unknown, all of
// the error counts.
double StructuredError(const RecordScore& score);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_SCORE_H_
