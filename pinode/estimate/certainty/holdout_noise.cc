#include "pinode/estimate/certainty/holdout_noise.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Share of the prediction in the measured content at the highest frequencies,
// from which on it counts as motion.
constexpr double kMostMotion = 0.05;
// Smallest significant difference of noise, in standard deviations.
constexpr double kLeastDeviations = 2.0;

// Content of a channel at the highest frequencies, and a flag that it is noise.
struct Floor {
  DifferencedVariance measured;
  bool is_noise = false;
};

Floor MeasureFloor(const MeasuredChannel& channel, const RecordScore& score,
                   int index) {
  Floor floor;
  floor.measured = VarianceOfDifferences(channel.values);
  const double motion =
      VarianceOfDifferences(score.prediction.row(index)).value;
  floor.is_noise =
      floor.measured.value > 0.0 && motion < kMostMotion * floor.measured.value;
  return floor;
}

}  // namespace

Vector HoldoutNoise(const IdentificationProblem& problem,
                    const TrainedSensors& trained, int record,
                    const std::vector<Vector>& sigmas,
                    const std::vector<RecordScore>& scores) {
  const size_t r = static_cast<size_t>(record);
  const IdentificationRecord& data = problem.records[r];
  Vector own = sigmas[r];
  if (data.role != IdentificationRecord::Role::kHoldout || !scores[r].finite) {
    return own;
  }
  for (int c = 0; c < own.size(); ++c) {
    const MeasuredChannel& channel = data.channels[static_cast<size_t>(c)];
    const std::optional<TrainedSensor>& sensor =
        trained[r][static_cast<size_t>(c)];
    if (channel.sigma > 0.0 || !sensor.has_value()) continue;
    const RecordScore& train = scores[sensor->record];
    if (!train.finite) continue;
    const Floor here = MeasureFloor(channel, scores[r], c);
    const Floor there =
        MeasureFloor(problem.records[sensor->record]
                         .channels[static_cast<size_t>(sensor->channel)],
                     train, sensor->channel);
    const double more = here.measured.value - there.measured.value;
    const double deviation =
        std::hypot(here.measured.deviation, there.measured.deviation);
    if (!here.is_noise || !there.is_noise ||
        !(std::abs(more) > kLeastDeviations * deviation)) {
      continue;
    }
    // The measured noise is a lower limit if training had less.
    own[c] = std::sqrt(std::max(here.measured.value, own[c] * own[c] + more));
  }
  return own;
}

std::string HoldoutNoiseRemark(const IdentificationRecord& record,
                               const Vector& training, const Vector& own) {
  std::vector<std::string> changes;
  for (int c = 0; c < own.size(); ++c) {
    if (own[c] == training[c]) continue;
    changes.push_back(record.channels[static_cast<size_t>(c)].observation.name +
                      " " + FormatNumber(own[c] / training[c], 3));
  }
  if (changes.empty()) return "";
  return "Record '" + record.name +
         "': noise relative to training, measured above the frequencies of "
         "the motion: " +
         Join(changes, ", ") + ".";
}

}  // namespace pinode
