// How well a model describes an ambient record.

#ifndef PINODE_ESTIMATE_AMBIENT_AMBIENT_SCORE_H_
#define PINODE_ESTIMATE_AMBIENT_AMBIENT_SCORE_H_

#include "pinode/base/types.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/problem/ambient_record.h"

namespace pinode {

// Scores the model at `free`, except for score->evidence. Sets the point of
// `cost`. False where the model fails there.
[[nodiscard]] bool ScoreAmbient(const Vector& free, AmbientCost* cost,
                                AmbientScore* score);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_SCORE_H_
