// Mode shapes by the names of their channels.

#ifndef PINODE_WATCH_CHANNEL_SHAPE_H_
#define PINODE_WATCH_CHANNEL_SHAPE_H_

#include <algorithm>
#include <complex>
#include <map>
#include <string>

#include "pinode/watch/store.h"

namespace pinode {

// Displacements at the channels that were used.
using ChannelShape = std::map<std::string, std::complex<double>>;

inline ChannelShape ShapeOf(const StoredRecord& record,
                            const StoredMode& mode) {
  ChannelShape shape;
  Eigen::Index place = 0;
  for (const StoredChannel& channel : record.channels) {
    if (!channel.fault.empty()) continue;
    if (place >= mode.shape.size()) break;
    shape[channel.name] = mode.shape[place++];
  }
  return shape;
}

// Sums over the channels that both shapes have, but for `without`.
struct ShapeProducts {
  std::complex<double> ab;
  double aa = 0.0;
  double bb = 0.0;

  ShapeProducts(const ChannelShape& a, const ChannelShape& b,
                const std::string& without = "") {
    for (const auto& [name, value] : a) {
      const auto other = b.find(name);
      if (other == b.end() || name == without) continue;
      ab += std::conj(value) * other->second;
      aa += std::norm(value);
      bb += std::norm(other->second);
    }
  }
  // 1 without a common channel: frequencies alone must then decide.
  double Mac() const {
    return aa > 0.0 && bb > 0.0 ? std::norm(ab) / (aa * bb) : 1.0;
  }
  double OneMinusMac() const { return std::max(0.0, 1.0 - Mac()); }
};

}  // namespace pinode

#endif  // PINODE_WATCH_CHANNEL_SHAPE_H_
