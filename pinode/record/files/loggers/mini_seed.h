// Reads miniSEED files (seismic recorders).

#ifndef PINODE_RECORD_FILES_LOGGERS_MINI_SEED_H_
#define PINODE_RECORD_FILES_LOGGERS_MINI_SEED_H_

#include <string>
#include <string_view>

#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Parses a file of miniSEED records: version 2 with libmseed, version 3 without
// a library (ParseMiniSeed3). A channel is called
// NET.STA.LOC.CHA; its values are what the recorder wrote, mostly counts. Gaps
// are missing samples. Refuses records that overlap, and gaps that are longer
// than the records.
[[nodiscard]] bool ParseMiniSeed(const std::string& bytes,
                                 const std::string& path,
                                 const ChannelFilter& wanted, LoggedFile* file,
                                 std::string* error);

// Returns true if this build has libmseed, for version 2.
bool CanReadMiniSeed();

// Returns true if a file that begins so is miniSEED, of version 2 or 3.
bool IsMiniSeedHeader(std::string_view begin);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_MINI_SEED_H_
