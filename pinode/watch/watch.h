// Main job of pinode_watch: new records into the store, and the analysis of
// all.

#ifndef PINODE_WATCH_WATCH_H_
#define PINODE_WATCH_WATCH_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pinode/watch/store.h"
#include "pinode/watch/structure_file.h"
#include "pinode/watch/watch_analysis.h"

namespace pinode {

// Loggers write a file in pieces that are closer than this.
inline constexpr int kQuietSeconds = 10;

struct WatchCalls {
  // Tells about a record that was stored, or about a file that cannot be read.
  std::function<void(const StoredRecord& record)> stored;
  std::function<void(const std::string& message)> unreadable;
  // Returns true if the caller wants to stop; asked between records.
  std::function<bool()> interrupted;
};

struct WatchCounts {
  int files = 0;   // that fit the pattern
  int stored = 0;  // new
  int known = 0;   // files whose content is in the store
  int unreadable = 0;
  int read = 0;     // opened to look at their content
  int growing = 0;  // written a few seconds ago, or meanwhile; left for later
  bool interrupted = false;
};

// Examines the files of `folder` that are not in the store, in the order of
// their names, and stores each in a transaction of its own. The store remembers
// their sizes and times, and files that have not changed are not read again.
// `skip_growing`: leaves files alone that were written a moment ago. Returns
// false, with one line, if the folder or the store cannot be used.
[[nodiscard]] bool StoreNewRecords(const WatchedStructure& structure,
                                   const std::string& folder, bool skip_growing,
                                   int64_t id, const WatchCalls& calls,
                                   Store* store, WatchCounts* counts,
                                   std::string* error);

// Returns a text that changes with the covariates' own files, by their sizes
// and times.
std::string CovariateFilesState(const WatchedStructure& structure);

// Analyses all records of the structure in the store. Covariates from files of
// their own are read anew, so that a corrected file counts. The events are not
// stored: whoever has told about them does that.
[[nodiscard]] bool AnalyseStore(const WatchedStructure& structure, int64_t id,
                                Store* store, WatchAnalysis* analysis,
                                std::string* error);

// Returns a date and time, such as "2024-03-01 12:00", UTC.
std::string DateText(double time);

}  // namespace pinode

#endif  // PINODE_WATCH_WATCH_H_
