// Reads tables from the files of data loggers, whatever their format.

#ifndef PINODE_RECORD_FILES_LOGGERS_LOGGER_TABLE_H_
#define PINODE_RECORD_FILES_LOGGERS_LOGGER_TABLE_H_

#include <string>
#include <vector>

#include "pinode/record/files/loggers/logged_file.h"
#include "pinode/record/table.h"

namespace pinode {

enum class LoggerFormat {
  kNone,
  kKnet,          // K-NET and KiK-net
  kStrongMotion,  // CSMIP, COSMOS and BHRC
  kTdms,
  kMiniSeed,
  kSac,
  kLvm
};

// Finds the format from the first bytes of a file; if these are of none, from
// the extension (.tdms, .mseed, .sac, .lvm, .v2, .knet). kNone for files that
// cannot be read.
LoggerFormat FindLoggerFormat(const std::string& path);

// True for formats of text, whose encoding matters.
bool IsLoggerText(LoggerFormat format);

// Reads a file of a format that FindLoggerFormat() returns. Text may be
// compressed (.gz). `encoding` is that of text; empty: found.
[[nodiscard]] bool ReadLoggedFile(const std::string& path, LoggerFormat format,
                                  const std::string& encoding,
                                  const ChannelFilter& wanted, LoggedFile* file,
                                  std::string* error);

// Does the same for bytes in memory.
[[nodiscard]] bool ParseLoggedFile(const std::string& bytes,
                                   const std::string& path, LoggerFormat format,
                                   const std::string& encoding,
                                   const ChannelFilter& wanted,
                                   LoggedFile* file, std::string* error);

// Reads the wanted channels as a table, see MakeLoggerTable().
[[nodiscard]] bool ReadLoggerTable(const std::string& path, LoggerFormat format,
                                   const std::string& encoding,
                                   const std::vector<std::string>& wanted,
                                   Table* table, std::string* error);

// Returns the unit that a file states for a channel, by its name in the table
// of units; empty: none, or no such channel.
std::string UnitOfLoggerChannel(const std::string& path, LoggerFormat format,
                                const std::string& encoding,
                                const std::string& name);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_LOGGER_TABLE_H_
