// Sensors against the history of the mode shapes.

#ifndef PINODE_WATCH_SENSOR_HISTORY_H_
#define PINODE_WATCH_SENSOR_HISTORY_H_

#include <string>
#include <vector>

#include "pinode/watch/store.h"
#include "pinode/watch/structure_file.h"

namespace pinode {

// Begin of a sensor's fault that the history shows.
struct SensorChange {
  int record = 0;  // index in the records
  std::string channel;
  std::string fault;  // end of a sentence that begins with the channel's name
};

// Compares the shapes of each record behind the reference with their means in
// the reference, and leaves out the channels that have changed: their faults
// are set, and their entries of the shapes are removed. Records are in the
// order of their times.
//
// One entry of every shape that is scaled by the same factor is a sensor: it
// was turned (-1), or it has another gain. Two entries that are exchanged in
// every shape are two sensors that were swapped. A phase that grows with the
// frequency is a late sensor. Damage changes the entries of each mode
// differently. Three modes at three channels are needed to tell, four channels
// for a gain, and three of the last five records must agree. The agreeing
// records among the last five lose the channel too: up to four records before
// the one that shows the fault change.
std::vector<SensorChange> LeaveOutChangedSensors(
    const std::vector<bool>& is_reference, const TrackingOptions& options,
    std::vector<StoredRecord>* records);

}  // namespace pinode

#endif  // PINODE_WATCH_SENSOR_HISTORY_H_
