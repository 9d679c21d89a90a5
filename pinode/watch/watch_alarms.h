// From the chart to alarms, notices and the all-clear.

#ifndef PINODE_WATCH_WATCH_ALARMS_H_
#define PINODE_WATCH_WATCH_ALARMS_H_

#include <vector>

#include "pinode/watch/normal_model.h"
#include "pinode/watch/structure_file.h"
#include "pinode/watch/watch_analysis.h"

namespace pinode {

// Sets lights, the light and events of an analysis that has a chart.
void RaiseAlarms(const WatchedStructure& structure,
                 const std::vector<Innovation>& innovations,
                 WatchAnalysis* analysis);

}  // namespace pinode

#endif  // PINODE_WATCH_WATCH_ALARMS_H_
