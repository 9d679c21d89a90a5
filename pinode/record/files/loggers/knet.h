// Reads accelerograms of K-NET and KiK-net (NIED, Japan).

#ifndef PINODE_RECORD_FILES_LOGGERS_KNET_H_
#define PINODE_RECORD_FILES_LOGGERS_KNET_H_

#include <string>

#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Parses a file in ASCII of K-NET or KiK-net: 17 lines of header, then whole
// numbers that the scale factor turns into gal. The one channel is called NS,
// EW or UD; at KiK-net's stations NS1, EW1, UD1 in the borehole and NS2, EW2,
// UD2 at the surface. The start is the record time minus the 15 s by which the
// recorder delays it, in UTC (the file has Japanese time). The mean is kept.
// Source: NIED, "About K-NET ASCII format", kyoshin.bosai.go.jp.
//
// `path` is used in messages only. Refuses with `path:line: ...`.
[[nodiscard]] bool ParseKnet(const std::string& text, const std::string& path,
                             const ChannelFilter& wanted, LoggedFile* file,
                             std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_KNET_H_
