#include "pinode/record/record.h"

#include <cmath>
#include <set>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {

const Channel* Record::FindChannel(const std::string& channel_name) const {
  for (const Channel& channel : channels) {
    if (channel.name == channel_name) return &channel;
  }
  return nullptr;
}

bool Record::IsValid(std::string* error) const {
  CHECK(error != nullptr);
  const std::string prefix = "record '" + name + "': ";
  if (!std::isfinite(start_time)) {
    *error = prefix + "its start time is not finite";
    return false;
  }
  if (!(sampling_step > 0.0) || !std::isfinite(sampling_step)) {
    *error = prefix + "its sampling step " + FormatNumber(sampling_step) +
             " is not positive";
    return false;
  }
  if (num_samples() < 2) {
    *error = prefix + "it has " + std::to_string(num_samples()) +
             " samples, at least two are needed";
    return false;
  }
  std::set<std::string> seen;
  for (const Channel& channel : channels) {
    if (channel.name.empty()) {
      *error = prefix + "a channel has no name";
      return false;
    }
    if (!seen.insert(channel.name).second) {
      *error = prefix + "two channels are named '" + channel.name + "'";
      return false;
    }
    if (channel.values.size() != num_samples()) {
      *error = prefix + "channel '" + channel.name + "' has " +
               std::to_string(channel.values.size()) + " samples, channel '" +
               channels[0].name + "' has " + std::to_string(num_samples());
      return false;
    }
  }
  return true;
}

}  // namespace pinode
