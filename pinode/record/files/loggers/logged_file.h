// Files of data loggers that state channels, rates, units and start times.

#ifndef PINODE_RECORD_FILES_LOGGERS_LOGGED_FILE_H_
#define PINODE_RECORD_FILES_LOGGERS_LOGGED_FILE_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/table.h"

namespace pinode {

// One channel with a clock of its own.
struct LoggerChannel {
  // Name that is unique in its file, such as "XX.STA.00.HNZ" or "group/a1".
  std::string name;
  // Last part of the name, "HNZ" or "a1". A case may use it where it is unique.
  std::string short_name;
  // Unit as the file writes it; empty: none.
  std::string unit;
  // Sampling step (s); 0: the file states none.
  double step = 0.0;
  // Time of the first sample (s) after the file's origin.
  double start = 0.0;
  // True if the start is a clock time.
  bool is_dated = false;
  // True for histories that were computed from another channel, such as
  // velocities of an accelerogram. They are read only if they are asked for.
  bool is_derived = false;
  Eigen::Index size = 0;
  Vector values;  // empty if not wanted; NaN: missing
  // Reason why the channel cannot be read ("it holds text"). Empty: none.
  std::string fault;
};

struct LoggedFile {
  std::string format;  // "K-NET", for messages
  // Clock time (UTC, or the logger's own) to which the starts refer.
  TimeOrigin origin;
  std::vector<LoggerChannel> channels;
  // Other names of the time column "t".
  std::vector<std::string> time_names;
  // Sentences on what was assumed, without a full stop.
  std::vector<std::string> remarks;
};

// Returns true for channels whose samples are wanted.
using ChannelFilter = std::function<bool(const LoggerChannel&)>;

// Sets the starts of channels from their clock times, in whole seconds since
// 1970 and a fraction. The origin becomes the earliest whole second.
struct StartTime {
  bool is_known = false;
  int64_t seconds = 0;
  double fraction = 0.0;
};
void SetStartTimes(const std::vector<StartTime>& times, LoggedFile* file);

// Appends "[2]", "[3]" to names that occur again.
void MakeNamesUnique(LoggedFile* file);

// Returns seconds since 1970-01-01 of a date in the Gregorian calendar. The
// month may exceed 12 and the day its month: they count on.
int64_t SecondsOfDate(int64_t year, int64_t month, int64_t day);

// Returns the columns of a table of all channels that were measured: "t" and
// their short names, where these are unique.
std::vector<std::string> AllLoggerColumns(const LoggedFile& file);

// Makes a table of the channels `wanted` (see ReadCsvTable), by name or short
// name, and the time "t" in seconds from the file's origin. An empty `wanted`
// means all channels that were measured, and the time.
//
// Channels of several rates are resampled to the lowest rate (Resample). A
// channel that is more than ten times slower than the fastest one, such as a
// temperature, stays as it is: its readings stand at their times, with missing
// samples between them. Channels that start or end at other times keep the
// common part. Table::reading says all this.
//
// Refuses channels whose samples lie between those of the others, and channels
// without a rate beside others with one.
[[nodiscard]] bool MakeLoggerTable(const LoggedFile& file,
                                   const std::string& path,
                                   const std::vector<std::string>& wanted,
                                   Table* table, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_LOGGED_FILE_H_
