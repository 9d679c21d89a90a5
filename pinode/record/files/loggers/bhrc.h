// Reads accelerograms of Iran's strong motion network (BHRC).

#ifndef PINODE_RECORD_FILES_LOGGERS_BHRC_H_
#define PINODE_RECORD_FILES_LOGGERS_BHRC_H_

#include <string>
#include <string_view>

#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Parses Volume 1 of the Building and Housing Research Center: accelerations
// that are not corrected, one component after the other. Each has
//
//   * VOL1DS FILE:  5523/01
//   ...
//   COMP L1
//   ...
//   NO. OF POINTS =  13056      DURATION =  65.280
//   UNITS ARE SECONDS AND G/10
//
// and a blank line, seven lines of whole numbers, seven of real numbers (the
// seventh number is the sampling rate in Hz), and the samples, ten a line in
// fields of 13. The channels are L1, V2, T3, as the components are called. They
// have no start: the header's time is that of the earthquake.
//
// Other volumes are refused. Source of the layout: files of the centre, and the
// reader of USGS' gmprocess.
[[nodiscard]] bool ParseBhrc(const std::string& text, const std::string& path,
                             const ChannelFilter& wanted, LoggedFile* file,
                             std::string* error);

// Returns true if the first line is that of such a file, of any volume.
bool IsBhrcTitle(std::string_view line);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_BHRC_H_
