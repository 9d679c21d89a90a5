#include "pinode/problem/assumed_noise.h"

#include <algorithm>
#include <map>
#include <string>

#include "pinode/base/statistics.h"

namespace pinode {

Vector AssumedNoise(const IdentificationRecord& record,
                    const NoiseTuning& tuning) {
  Vector sigmas(static_cast<int>(record.channels.size()));
  for (int c = 0; c < sigmas.size(); ++c) {
    const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
    sigmas[c] = channel.sigma > 0.0
                    ? channel.sigma
                    : std::max(tuning.first_share *
                                   StandardDeviationOfPresent(channel.values),
                               kLeastNoise);
  }
  return sigmas;
}

std::vector<Vector> AssumedNoise(const IdentificationProblem& problem,
                                 const NoiseTuning& tuning) {
  std::vector<Vector> sigmas;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role == IdentificationRecord::Role::kTrain) {
      sigmas.push_back(AssumedNoise(record, tuning));
    }
  }
  return sigmas;
}

TrainedSensors FindTrainedSensors(const IdentificationProblem& problem) {
  std::map<std::string, TrainedSensor> fitted;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& train = problem.records[r];
    if (train.role != IdentificationRecord::Role::kTrain) continue;
    for (size_t c = 0; c < train.channels.size(); ++c) {
      if (!train.channels[c].fit) continue;
      fitted[train.channels[c].observation.name] = {r, static_cast<int>(c)};
    }
  }
  TrainedSensors trained;
  for (const IdentificationRecord& record : problem.records) {
    trained.emplace_back();
    for (const MeasuredChannel& channel : record.channels) {
      const auto found = fitted.find(channel.observation.name);
      trained.back().push_back(found == fitted.end()
                                   ? std::nullopt
                                   : std::make_optional(found->second));
    }
  }
  return trained;
}

std::vector<Vector> NoiseOfAllRecords(const IdentificationProblem& problem,
                                      const TrainedSensors& trained,
                                      const std::vector<Vector>& sigmas,
                                      const NoiseTuning& tuning) {
  std::vector<Vector> all;
  size_t t = 0;
  for (const IdentificationRecord& record : problem.records) {
    all.push_back(record.role == IdentificationRecord::Role::kTrain
                      ? sigmas[t++]
                      : AssumedNoise(record, tuning));
  }
  for (size_t r = 0; r < all.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role == IdentificationRecord::Role::kTrain) continue;
    for (size_t c = 0; c < record.channels.size(); ++c) {
      const std::optional<TrainedSensor>& sensor = trained[r][c];
      if (record.channels[c].sigma > 0.0 || !sensor.has_value()) continue;
      all[r][static_cast<int>(c)] = all[sensor->record][sensor->channel];
    }
  }
  return all;
}

}  // namespace pinode
