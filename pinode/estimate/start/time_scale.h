// Whether a record's time can be that of its model.

#ifndef PINODE_ESTIMATE_START_TIME_SCALE_H_
#define PINODE_ESTIMATE_START_TIME_SCALE_H_

#include <string>
#include <vector>

#include "pinode/problem/identification_problem.h"

namespace pinode {

// False where a driven training record lasts less than a hundredth of a period
// of the fastest mode that the model's matrices have at the initial values, and
// stiffness or damping is to be found from it by groups alone: nothing swings
// in it, whatever is found is that of another structure, and fits. *error names
// the record and the unit that its time is likely to be in. Models with other
// terms are not refused, for their matrices need not say how fast they are.
[[nodiscard]] bool IsTimeScalePossible(const IdentificationProblem& problem,
                                       std::string* error);

// A sentence for each driven record that lasts less than a tenth of a period of
// the slowest elastic mode, or whose samples are more than two such periods
// apart; of models with terms other than groups less than a hundredth and more
// than twenty. Both may be meant (a slow test; a stiff structure on soft
// springs); more often time is in another unit.
std::vector<std::string> TimeScaleRemarks(const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_TIME_SCALE_H_
