// Outlines of trajectories, kept between the stages of a fit.

#ifndef PINODE_ESTIMATE_SHOOTING_TRAJECTORY_OUTLINE_H_
#define PINODE_ESTIMATE_SHOOTING_TRAJECTORY_OUTLINE_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/shooting/multiple_shooting.h"

namespace pinode {

// States of a record's trajectory at the segments' starts, from which those
// between can be had again: all of them would be most of the memory of a long
// record.
struct TrajectoryOutline {
  std::vector<Eigen::Index>
      samples;          // first samples of the segments, then the last one
  Matrix starts;        // num_states x segments
  Vector mean_squares;  // of the states, over the record
};

// Outlines of all training records, at the free parameters.
struct TrajectoryOutlines {
  Vector free;
  std::vector<TrajectoryOutline> records;
};

// Runs all segments at `free` from the starts of `shooting`: states at every
// sample, per training record. False where a trajectory is not finite.
[[nodiscard]] bool RunTrajectories(const MultipleShooting& shooting,
                                   const Vector& free,
                                   std::vector<Matrix>* states);
// The same from an outline, whatever was evaluated.
[[nodiscard]] bool RunTrajectories(const MultipleShooting& shooting,
                                   const TrajectoryOutlines& outlines,
                                   std::vector<Matrix>* states);
// Outlines of the trajectories at `free` from the starts of `shooting`.
[[nodiscard]] bool OutlineTrajectories(const MultipleShooting& shooting,
                                       const Vector& free,
                                       TrajectoryOutlines* outlines);

// Cuts as SetSegments does, at trajectories of which an outline was kept. They
// are run again where starts lie between those of the outline; false where they
// are not finite.
[[nodiscard]] bool SetSegmentsAlong(Eigen::Index samples,
                                    const TrajectoryOutlines& outlines,
                                    MultipleShooting* shooting);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_TRAJECTORY_OUTLINE_H_
