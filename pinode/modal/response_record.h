// What sensors recorded of a structure.

#ifndef PINODE_MODAL_RESPONSE_RECORD_H_
#define PINODE_MODAL_RESPONSE_RECORD_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// One place and direction on the structure.
struct ResponseChannel {
  std::string name;
  // What is measured there, as a derivative of the displacement by time: 0
  // displacement, 1 velocity, 2 acceleration.
  int derivative = 2;
};

// Channels that share a uniform grid.
struct ResponseRecord {
  std::string name;
  double sampling_step = 0.0;  // s
  std::vector<ResponseChannel> channels;
  Matrix samples;  // channels x samples; NaN: missing
  // Measured loads, in any units: inputs x samples, complete; no rows: none.
  Matrix inputs;
  // The structure is left to itself from the first sample on.
  bool free_decay = false;

  int num_channels() const { return static_cast<int>(channels.size()); }
  Eigen::Index num_samples() const { return samples.cols(); }
  double duration() const {
    return static_cast<double>(num_samples()) * sampling_step;
  }

  // At least one channel, a positive step, a row of samples for each channel,
  // of which some are present and which are not all alike, derivatives 0, 1 or
  // 2, names given once, inputs finite and of the same length. On failure
  // *error names the channel.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// As of a record of any kind (record/channel_faults.h).
std::vector<std::string> FindChannelFaults(const ResponseRecord& record);

}  // namespace pinode

#endif  // PINODE_MODAL_RESPONSE_RECORD_H_
