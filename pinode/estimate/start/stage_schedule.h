// Lengths of the segments, from stage to stage.

#ifndef PINODE_ESTIMATE_START_STAGE_SCHEDULE_H_
#define PINODE_ESTIMATE_START_STAGE_SCHEDULE_H_

#include <vector>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// Length in samples of the first stage's segments: a quarter of the longest
// period of the model before the identification, within the limits of
// `tuning`.
Eigen::Index FirstSegmentSamples(const IdentificationProblem& problem,
                                 const StageTuning& tuning);

// Segment lengths in samples, growing by a constant factor while they are
// shorter than half of the longest training record; the last entry, 0, is a
// single segment a record. Short segments reach solutions that a long free run
// does not lead to (H. G. Bock, "Numerical treatment of inverse problems in
// chemical reaction kinetics", 1981). `has_networks`: the model lacks a part
// that is to be learned, and begins with shorter ones.
std::vector<Eigen::Index> StageLengths(const IdentificationProblem& problem,
                                       const IdentificationOptions& options,
                                       bool has_networks);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_STAGE_SCHEDULE_H_
