// Noise of channels that no fit has estimated.

#ifndef PINODE_PROBLEM_ASSUMED_NOISE_H_
#define PINODE_PROBLEM_ASSUMED_NOISE_H_

#include <optional>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// Smallest noise of a channel, in its own unit, so that a constant channel has
// a finite weight.
constexpr double kLeastNoise = 1e-290;

// Returns the standard deviations with which a fit begins, one per channel in
// the channel's unit: the given sigma, or else a share of the channel's spread
// (NoiseTuning::first_share).
Vector AssumedNoise(const IdentificationRecord& record,
                    const NoiseTuning& tuning);
// Returns the same for each training record.
std::vector<Vector> AssumedNoise(const IdentificationProblem& problem,
                                 const NoiseTuning& tuning);

// A channel of a training record: indices into problem.records and into the
// record's channels.
struct TrainedSensor {
  size_t record = 0;
  int channel = 0;
};

// Trained sensors of all channels, per record and channel.
using TrainedSensors = std::vector<std::vector<std::optional<TrainedSensor>>>;

// Finds for each channel the last training record in which a sensor of the same
// name was fitted. Empty where there is none.
TrainedSensors FindTrainedSensors(const IdentificationProblem& problem);

// Returns the noise of all records after a fit. `sigmas` are those of the
// training records. A channel of another record takes its given sigma, else the
// sigma of its sensor in `trained`, else AssumedNoise.
std::vector<Vector> NoiseOfAllRecords(const IdentificationProblem& problem,
                                      const TrainedSensors& trained,
                                      const std::vector<Vector>& sigmas,
                                      const NoiseTuning& tuning);

}  // namespace pinode

#endif  // PINODE_PROBLEM_ASSUMED_NOISE_H_
