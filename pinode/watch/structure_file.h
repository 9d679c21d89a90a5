// Structure file of pinode_watch: records to watch, covariates, and the alarm.

#ifndef PINODE_WATCH_STRUCTURE_FILE_H_
#define PINODE_WATCH_STRUCTURE_FILE_H_

#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/modal/identify_modes.h"

namespace pinode {

// Records of a structure, all read alike.
struct WatchedRecords {
  // Folder of the files, absolute or relative to the working directory.
  std::string folder;
  // Shell pattern of their names.
  std::string pattern = "*.csv";
  std::vector<std::string> columns = {"all"};
  std::vector<std::string> quantities;
  std::string time_column;
  // Format of strptime of the clock times in the files. Empty: found.
  std::string time_format;
  double sampling_rate_hz = 0.0;
  // Format of strptime by which the name of a file, without its extension,
  // gives the time of its first sample. Empty: the clock times of the file.
  std::string time_in_name;
};

// Covariate of the frequencies, such as a temperature.
struct WatchedCovariate {
  std::string name;
  std::string column;
  // Value at which the slope changes. NaN: no kink.
  double kink = kNaN;
  // Table with clock times. Empty: the column is in the records' files.
  std::string file;
  std::string time_column;
  double largest_gap_hours = 3.0;
};

// Period that the normal behaviour is learned from. Either a number of records,
// or the records between two times, in s since 1970.
struct ReferencePeriod {
  int num_records = 0;
  double from = -kInfinity;
  double to = kInfinity;
};

struct TrackingOptions {
  // Largest change of a frequency, as a fraction, between a mode and the recent
  // mean of its history.
  double largest_step = 0.1;
  // Smallest MAC between a mode and its history.
  double least_mac = 0.6;
  // Share of the reference records that must have a mode if its frequency is to
  // be watched.
  double least_presence = 0.5;
};

struct ChartOptions {
  double false_alarms_per_year = 1.0;
  // Memory of the moving average, in days. With 3, a loss of 2 % was found in a
  // median of 1.6 days and 0.85 false alarms a year were counted
  // (tests/benchmarks/README.md). Others were not measured.
  double memory_days = 3.0;
  // Time without a new exceedance after which an alarm ends, in days.
  double clear_days = 7.0;
  // Records that are simulated for the limits, at the most. A million records
  // take about a second.
  int most_simulated = 1000000;
};

// Messages about events. A way without an address is not used.
struct NotifyOptions {
  std::vector<std::string> kinds = {"alarm", "all-clear"};
  std::string webhook;  // http:// or https://
  std::string mail;     // smtp:// or smtps://
  bool mail_tls = true;
  // User of the mail server. Empty: it asks for none.
  std::string user;
  std::string from;
  std::vector<std::string> to;
};

struct WatchedStructure {
  std::string path;
  std::string name;
  WatchedRecords records;
  std::vector<WatchedCovariate> covariates;
  ModeIdentificationOptions modes;
  // Table [modes] as it was written, to notice a change.
  std::string modes_text;
  ReferencePeriod reference;
  TrackingOptions tracking;
  ChartOptions chart;
  NotifyOptions notify;
  // Names that people gave to modes, by their frequencies in Hz. They are in
  // the store, not in the file.
  std::vector<std::pair<double, std::string>> mode_names;
};

// Reads a structure file. On failure *error is one line and *structure is
// untouched.
[[nodiscard]] bool ReadStructureFile(const std::string& path,
                                     WatchedStructure* structure,
                                     std::string* error);

// Does the same for a text in memory; `path` finds the folders and serves
// messages.
[[nodiscard]] bool ParseStructureFile(const std::string& text,
                                      const std::string& path,
                                      WatchedStructure* structure,
                                      std::string* error);

// Returns the settings that the stored results of a record depend on, as one
// text. A store refuses records that were read with other settings.
std::string ReadingSettings(const WatchedStructure& structure);

// Parses a date or a date with time, such as "2024-03-01 12:00". Returns false
// unless it is clear which day is meant. *seconds: since 1970, in UTC.
[[nodiscard]] bool ParseDate(const std::string& text, double* seconds);
// Does the same by a format of strptime.
[[nodiscard]] bool ParseDateBy(const std::string& format,
                               const std::string& text, double* seconds);

}  // namespace pinode

#endif  // PINODE_WATCH_STRUCTURE_FILE_H_
