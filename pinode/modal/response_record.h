// Sensor records of a structure.

#ifndef PINODE_MODAL_RESPONSE_RECORD_H_
#define PINODE_MODAL_RESPONSE_RECORD_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Sensor: one place and direction on the structure.
struct ResponseChannel {
  std::string name;
  // Measured quantity, as the order of the derivative of the displacement with
  // respect to time. 0: displacement, 1: velocity, 2: acceleration.
  int derivative = 2;
};

// Channels that were sampled together, at equal time steps.
struct ResponseRecord {
  std::string name;
  double sampling_step = 0.0;  // s
  std::vector<ResponseChannel> channels;
  // Samples, channels x samples, each row in any unit. NaN: missing.
  Matrix samples;
  // Measured loads, inputs x samples, each row in any unit, without missing
  // samples. No rows: no load was measured.
  Matrix inputs;
  // True for a free decay: no load acts from the first sample on.
  bool free_decay = false;

  int num_channels() const { return static_cast<int>(channels.size()); }
  Eigen::Index num_samples() const { return samples.cols(); }
  // Duration in s.
  double duration() const {
    return static_cast<double>(num_samples()) * sampling_step;
  }

  // Checks the record. On failure returns false, and *error names the channel
  // and the violated rule. The rules are:
  // - The record has at least one channel, a positive step, and a row of
  //   samples for each channel. Names of channels are unique. Derivatives are
  //   0, 1 or 2.
  // - In each row some samples are present, and they are not all equal.
  // - Inputs are finite, and as many as samples.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Returns the faults of channels, such as a clipped signal, one sentence each.
// pinode/record/channel_faults.h lists the faults.
std::vector<std::string> FindChannelFaults(const ResponseRecord& record);

}  // namespace pinode

#endif  // PINODE_MODAL_RESPONSE_RECORD_H_
