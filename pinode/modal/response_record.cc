#include "pinode/modal/response_record.h"

#include <cmath>
#include <set>

#include "pinode/base/strings.h"
#include "pinode/record/channel_faults.h"

namespace pinode {

bool ResponseRecord::IsValid(std::string* error) const {
  const std::string where = "record '" + name + "'";
  if (channels.empty()) {
    *error = where + " has no channel, expected at least one";
    return false;
  }
  if (!(sampling_step > 0.0) || !std::isfinite(sampling_step)) {
    *error = where + " has a sampling step of " + FormatNumber(sampling_step) +
             " s, expected a positive one";
    return false;
  }
  if (samples.rows() != num_channels()) {
    *error = where + " has " + std::to_string(samples.rows()) +
             " rows of samples for " + std::to_string(num_channels()) +
             " channels";
    return false;
  }
  if (inputs.rows() > 0 &&
      (inputs.cols() != samples.cols() || !inputs.allFinite())) {
    *error = where + " has loads of " + std::to_string(inputs.cols()) +
             " samples but responses of " + std::to_string(samples.cols()) +
             ", expected as many, all of them finite";
    return false;
  }
  std::set<std::string> seen;
  for (int c = 0; c < num_channels(); ++c) {
    const ResponseChannel& channel = channels[static_cast<size_t>(c)];
    const std::string at = where + ", channel '" + channel.name + "'";
    if (!seen.insert(channel.name).second) {
      *error = at + ": this name is used twice, expected different names";
      return false;
    }
    if (channel.derivative < 0 || channel.derivative > 2) {
      *error = at + " is the derivative " + std::to_string(channel.derivative) +
               " of a displacement, expected 0, 1 or 2";
      return false;
    }
    const std::string useless = WhyChannelIsUseless(samples.row(c));
    if (!useless.empty()) {
      *error = at + " " + useless;
      return false;
    }
  }
  return true;
}

std::vector<std::string> FindChannelFaults(const ResponseRecord& record) {
  std::vector<std::string> names;
  for (const ResponseChannel& channel : record.channels) {
    names.push_back(channel.name);
  }
  return FindChannelFaults(names, record.samples);
}

}  // namespace pinode
