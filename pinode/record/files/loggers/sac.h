// Reads SAC files (Seismic Analysis Code).

#ifndef PINODE_RECORD_FILES_LOGGERS_SAC_H_
#define PINODE_RECORD_FILES_LOGGERS_SAC_H_

#include <string>
#include <string_view>

#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Parses an evenly spaced time series of SAC, version 6 or 7, in either byte
// order: 632 bytes of header, then numbers of 4 bytes. The one channel is
// called after its component (KCMPNM), or "data". SAC states no unit. Version 7
// has the step in double precision; that of version 6 is rounded to 7 digits.
// Source: IRIS, "SAC data file format".
[[nodiscard]] bool ParseSac(const std::string& bytes, const std::string& path,
                            const ChannelFilter& wanted, LoggedFile* file,
                            std::string* error);

// Returns true if a file that begins so is one of SAC.
bool IsSacHeader(std::string_view begin);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_SAC_H_
