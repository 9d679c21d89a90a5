#include "pinode/estimate/stage_schedule.h"

#include <algorithm>
#include <cmath>

#include "pinode/estimate/initial_states.h"

namespace pinode {

int FirstSegmentSamples(const IdentificationProblem& problem,
                        const StageTuning& tuning) {
  int shortest = 0;
  double step = 0.0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    shortest = shortest == 0 ? record.num_samples()
                             : std::min(shortest, record.num_samples());
    step = std::max(step, record.sampling_step());
  }
  int samples = tuning.least_first_samples;
  const std::vector<double> frequencies = ModelFrequencies(problem);
  if (!frequencies.empty()) {
    constexpr double kQuarterTurn = 1.5707963267948966;
    samples = static_cast<int>(
        std::min(1e6, std::ceil(kQuarterTurn / frequencies.front() / step)));
  }
  return std::clamp(
      samples, tuning.least_first_samples,
      std::max(tuning.least_first_samples,
               static_cast<int>(tuning.most_first_share * shortest)));
}

std::vector<int> StageLengths(const IdentificationProblem& problem,
                              const IdentificationOptions& options,
                              bool has_networks) {
  if (options.shooting == IdentificationOptions::Shooting::kSingle) return {0};
  const StageTuning& tuning = options.tuning.stages;
  int longest = 0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    longest = std::max(longest, record.num_samples());
  }
  std::vector<int> lengths;
  int first = options.segment_samples;
  if (first == 0) {
    first = FirstSegmentSamples(problem, tuning);
    if (has_networks) {
      first =
          std::max(tuning.least_first_samples, first / tuning.network_divisor);
    }
  }
  for (int length = first; 2 * length < longest; length *= tuning.growth) {
    lengths.push_back(length);
  }
  lengths.push_back(0);
  return lengths;
}

}  // namespace pinode
