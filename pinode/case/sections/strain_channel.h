// quantity = "strain" of [[record.channel]]: a gauge between DOFs.

#ifndef PINODE_CASE_SECTIONS_STRAIN_CHANNEL_H_
#define PINODE_CASE_SECTIONS_STRAIN_CHANNEL_H_

#include "pinode/case/sections/record_section.h"
#include "pinode/case/text/toml_table.h"

namespace pinode {

// Converts the relative motion of a gauge's ends in channel->weights to strain,
// by `gauge_length` and, of rotations, `distance` (both in the model's unit of
// length). Refuses a strain without a positive length or with a distance of
// zero, and these keys in a channel of another quantity.
[[nodiscard]] bool ReadStrainKeys(const TomlTable& table,
                                  ChannelSection* channel);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_STRAIN_CHANNEL_H_
