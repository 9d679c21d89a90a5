// Measured time histories on a uniform grid.

#ifndef PINODE_RECORD_RECORD_H_
#define PINODE_RECORD_RECORD_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// One measured quantity over time. NaN marks a missing sample.
struct Channel {
  std::string name;
  std::string unit = "1";
  Vector values;
};

// Channels that share one grid: sample i is at start_time + i * sampling_step.
struct Record {
  std::string name;
  double start_time = 0.0;
  double sampling_step = 0.0;
  std::vector<Channel> channels;

  // Returns the number of samples of every channel; 0 without channels.
  Eigen::Index num_samples() const {
    return channels.empty() ? 0 : channels[0].values.size();
  }
  double time(Eigen::Index sample) const {
    return start_time + static_cast<double>(sample) * sampling_step;
  }
  // Returns the time from the first sample to the last.
  double duration() const {
    return channels.empty()
               ? 0.0
               : static_cast<double>(num_samples() - 1) * sampling_step;
  }
  // Returns the channel of that name, or null if there is none.
  const Channel* FindChannel(const std::string& channel_name) const;

  // Checks the record: at least two samples, the same number in each channel, a
  // finite start, a positive step, and unique, non-empty channel names. On
  // failure *error gives the reason.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

}  // namespace pinode

#endif  // PINODE_RECORD_RECORD_H_
