// Sensor records of a structure.

#ifndef PINODE_MODAL_RESPONSE_RECORD_H_
#define PINODE_MODAL_RESPONSE_RECORD_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// One place and direction on the structure.
struct ResponseChannel {
  std::string name;
  // Measured quantity, as the order of the time derivative of the displacement:
  // 0 displacement, 1 velocity, 2 acceleration.
  int derivative = 2;
};

// Channels that share a uniform grid.
struct ResponseRecord {
  std::string name;
  double sampling_step = 0.0;  // s
  std::vector<ResponseChannel> channels;
  Matrix samples;  // channels x samples; NaN: missing
  // Measured loads, in any units: inputs x samples, complete. No rows: no loads
  // measured.
  Matrix inputs;
  // True for a free decay: no load acts from the first sample on.
  bool free_decay = false;

  int num_channels() const { return static_cast<int>(channels.size()); }
  Eigen::Index num_samples() const { return samples.cols(); }
  double duration() const {
    return static_cast<double>(num_samples()) * sampling_step;
  }

  // Checks the record. It needs at least one channel, a positive step, and a
  // row of samples for each channel. Some samples of a row are present, and
  // they are not all alike. Derivatives are 0, 1 or 2. Names are unique. Inputs
  // are finite and of the same length. On failure *error names the channel.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Returns the faults of the channels, as for a record of any kind
// (record/channel_faults.h).
std::vector<std::string> FindChannelFaults(const ResponseRecord& record);

}  // namespace pinode

#endif  // PINODE_MODAL_RESPONSE_RECORD_H_
