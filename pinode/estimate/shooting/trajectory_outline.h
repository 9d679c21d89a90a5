// What is kept of trajectories between the stages of a fit.

#ifndef PINODE_ESTIMATE_SHOOTING_TRAJECTORY_OUTLINE_H_
#define PINODE_ESTIMATE_SHOOTING_TRAJECTORY_OUTLINE_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Of a record's trajectory the states at the segments' starts, from which those
// between can be had again: all of them would be most of the memory of a long
// record.
struct TrajectoryOutline {
  std::vector<Eigen::Index>
      samples;          // first samples of the segments, then the last one
  Matrix starts;        // num_states x segments
  Vector mean_squares;  // of the states, over the record
};

// Of all training records, at the free parameters.
struct TrajectoryOutlines {
  Vector free;
  std::vector<TrajectoryOutline> records;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_TRAJECTORY_OUTLINE_H_
