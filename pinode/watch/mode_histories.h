// Modes of all records, joined to histories.

#ifndef PINODE_WATCH_MODE_HISTORIES_H_
#define PINODE_WATCH_MODE_HISTORIES_H_

#include <vector>

#include "pinode/watch/store.h"
#include "pinode/watch/structure_file.h"

namespace pinode {

// One mode over time. Of a record it has one mode at most, and each mode is in
// one history.
struct ModeHistory {
  struct Point {
    int record = 0;  // index in the records
    int mode = 0;    // index in StoredRecord::modes
  };
  std::vector<Point> points;  // ascending records
};

// Joins the modes of records, which are in the order of their times. The modes
// of a record are assigned to the histories all at once, by frequency and by
// shape (MAC at the channels that both have). The assignment has the smallest
// sum of costs. A mode that fits no history begins one.
//
// A frequency may move from the recent mean of its history by what
// TrackingOptions allow and by three standard deviations of the estimates.
std::vector<ModeHistory> JoinModes(const std::vector<StoredRecord>& records,
                                   const TrackingOptions& options);

}  // namespace pinode

#endif  // PINODE_WATCH_MODE_HISTORIES_H_
