// Cuts of the training records at given trajectories.

#ifndef PINODE_ESTIMATE_SHOOTING_SEGMENT_CUT_H_
#define PINODE_ESTIMATE_SHOOTING_SEGMENT_CUT_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/shooting/multiple_shooting.h"

namespace pinode {

// Cuts every training record into segments of about `samples` samples; 0: one
// segment a record. Starts are taken from the trajectories given (states at
// every sample of each record, num_states x samples).
void SetSegments(Eigen::Index samples, const std::vector<Matrix>& trajectories,
                 MultipleShooting* shooting);
// The same with all starts at rest.
void SetSegmentsAtRest(Eigen::Index samples, MultipleShooting* shooting);

// True if every record is in one piece.
bool IsSingleShooting(const MultipleShooting& shooting);
// True if any record has a start to be found, be it that of a later segment
// alone.
bool HasFreeStarts(const MultipleShooting& shooting);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_SEGMENT_CUT_H_
