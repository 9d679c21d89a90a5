// One record of a watched structure: its sensors are checked, and its modes are
// found.

#ifndef PINODE_WATCH_EXAMINE_RECORD_H_
#define PINODE_WATCH_EXAMINE_RECORD_H_

#include <string>

#include "pinode/watch/store.h"
#include "pinode/watch/structure_file.h"

namespace pinode {

// Examines the file at `path`, which holds `content`. Channels with a fault are
// left out: those that are absent, dead, hanging, clipped or spiked, and those
// that repeat another one. A record without a usable channel, without a time or
// without the length that modes need gets a refusal, a sentence.
StoredRecord ExamineRecord(const WatchedStructure& structure,
                           const std::string& path, const std::string& content);

// Returns the fault of a channel's samples as the end of a sentence that begins
// with its name; empty: none.
std::string FaultOfSamples(const Vector& values);

// Sets covariates that are in files of their own, by interpolation to the
// middle of each record. Values that are missing stay absent. Only records
// without the covariate are touched.
[[nodiscard]] bool FillCovariates(const WatchedStructure& structure,
                                  std::vector<StoredRecord>* records,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_WATCH_EXAMINE_RECORD_H_
