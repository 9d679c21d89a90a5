#include "pinode/case/sections/strain_channel.h"

#include <string>

#include "pinode/dynamics/observation.h"

namespace pinode {

bool ReadStrainKeys(const TomlTable& table, ChannelSection* channel) {
  if (channel->quantity != Quantity::kStrain) {
    for (const char* key : {"gauge_length", "distance"}) {
      if (!table.Has(key)) continue;
      return table.Fail(key, std::string("'") + key + "' of a channel of " +
                                 QuantityName(channel->quantity) +
                                 ", expected quantity = \"strain\", or no '" +
                                 key + "'");
    }
    return true;
  }
  if (!table.RequireKey("gauge_length",
                        "the length between the gauge's ends, in the model's "
                        "unit of length")) {
    return false;
  }
  const double length = table.PositiveNumber("gauge_length", 1.0);
  const double distance = table.Number("distance", 1.0);
  if (!table.errors()->ok()) return false;
  if (distance == 0.0) {
    return table.Fail("distance",
                      "'distance' is 0, but the neutral axis has no strain "
                      "from bending. Give the distance from it, or leave it "
                      "out for a combination of displacements");
  }
  channel->weights = table.Has("distance")
                         ? BendingStrain(channel->weights, distance, length)
                         : AxialStrain(channel->weights, length);
  return true;
}

}  // namespace pinode
