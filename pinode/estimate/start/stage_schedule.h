// Lengths of the segments, from stage to stage.

#ifndef PINODE_ESTIMATE_START_STAGE_SCHEDULE_H_
#define PINODE_ESTIMATE_START_STAGE_SCHEDULE_H_

#include <vector>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// Returns the length in samples of the first stage's segments: a quarter of the
// initial model's longest period, within the limits of `tuning`.
Eigen::Index FirstSegmentSamples(const IdentificationProblem& problem,
                                 const StageTuning& tuning);

// Returns segment lengths in samples, growing by a constant factor while they
// are shorter than half of the longest training record. The last entry, 0, is a
// single segment per record. Short segments reach solutions that a long
// simulation misses (H. G. Bock, "Numerical treatment of inverse problems in
// chemical reaction kinetics", 1981). `has_networks`: the model lacks a part
// that is to be learned, and begins with shorter segments.
std::vector<Eigen::Index> StageLengths(const IdentificationProblem& problem,
                                       const IdentificationOptions& options,
                                       bool has_networks);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_STAGE_SCHEDULE_H_
