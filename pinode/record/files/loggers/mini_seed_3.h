// Reads miniSEED files of version 3.

#ifndef PINODE_RECORD_FILES_LOGGERS_MINI_SEED_3_H_
#define PINODE_RECORD_FILES_LOGGERS_MINI_SEED_3_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Parses a file of miniSEED 3 records, without a library: whole numbers of 16
// and 32 bits, real ones of 32 and 64 bits, Steim 1 and 2. The checksum of each
// record must be right. A channel FDSN:NET_STA_LOC_H_N_Z is called
// NET.STA.LOC.HNZ; another source identifier is the name as it stands.
//
// Source: FDSN, "miniSEED 3" (2023), docs.fdsn.org.
[[nodiscard]] bool ParseMiniSeed3(const std::string& bytes,
                                  const std::string& path,
                                  const ChannelFilter& wanted, LoggedFile* file,
                                  std::string* error);

// Returns true if a file that begins so is miniSEED 3.
bool IsMiniSeed3(std::string_view begin);

// Unpacks `count` samples of Steim 1 or 2 (`version`), big endian. Returns an
// empty text, or what is wrong.
std::string UnpackSteim(std::string_view frames, int version, int64_t count,
                        std::vector<double>* values);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_MINI_SEED_3_H_
