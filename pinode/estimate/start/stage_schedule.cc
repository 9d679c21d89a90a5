#include "pinode/estimate/start/stage_schedule.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/estimate/start/initial_states.h"

namespace pinode {

Eigen::Index FirstSegmentSamples(const IdentificationProblem& problem,
                                 const StageTuning& tuning) {
  Eigen::Index shortest = 0;
  double step = 0.0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    shortest = shortest == 0 ? record.num_samples()
                             : std::min(shortest, record.num_samples());
    step = std::max(step, record.sampling_step());
  }
  Eigen::Index samples = tuning.least_first_samples;
  const std::vector<double> frequencies = ModelFrequencies(problem);
  if (!frequencies.empty()) {
    constexpr double kQuarterTurn = 0.25 * kTwoPi;
    samples = static_cast<Eigen::Index>(
        std::min(1e6, std::ceil(kQuarterTurn / frequencies.front() / step)));
  }
  return std::clamp<Eigen::Index>(
      samples, tuning.least_first_samples,
      std::max<Eigen::Index>(
          tuning.least_first_samples,
          static_cast<Eigen::Index>(tuning.most_first_share *
                                    static_cast<double>(shortest))));
}

std::vector<Eigen::Index> StageLengths(const IdentificationProblem& problem,
                                       const IdentificationOptions& options,
                                       bool has_networks) {
  if (options.shooting == IdentificationOptions::Shooting::kSingle) return {0};
  const StageTuning& tuning = options.tuning.stages;
  Eigen::Index longest = 0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    longest = std::max(longest, record.num_samples());
  }
  std::vector<Eigen::Index> lengths;
  Eigen::Index first = options.segment_samples;
  if (first == 0) {
    first = FirstSegmentSamples(problem, tuning);
    if (has_networks) {
      first = std::max<Eigen::Index>(tuning.least_first_samples,
                                     first / tuning.network_divisor);
    }
  }
  for (Eigen::Index length = first; 2 * length < longest;
       length *= tuning.growth) {
    lengths.push_back(length);
  }
  lengths.push_back(0);
  return lengths;
}

}  // namespace pinode
