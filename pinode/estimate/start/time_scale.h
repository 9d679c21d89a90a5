// Plausibility of a record's time scale.

#ifndef PINODE_ESTIMATE_START_TIME_SCALE_H_
#define PINODE_ESTIMATE_START_TIME_SCALE_H_

#include <string>
#include <vector>

#include "pinode/problem/identification_problem.h"

namespace pinode {

// Returns false if both hold: a driven training record lasts less than a
// hundredth of a period of the initial model's fastest mode, and stiffness or
// damping is to be found from it by groups alone. Such a record contains no
// vibration; the result would fit, but describe another structure. *error names
// the record and the likely unit of its time. Models with other terms are not
// refused, because their matrices need not determine how fast they are.
[[nodiscard]] bool IsTimeScalePossible(const IdentificationProblem& problem,
                                       std::string* error);

// Returns a sentence for each driven record that lasts less than a tenth of a
// period of the slowest elastic mode, or whose samples are more than two such
// periods apart. For models with terms other than groups the limits are a
// hundredth and twenty. Both may be intended (a slow test; a stiff structure on
// soft springs); more often the time has another unit.
std::vector<std::string> TimeScaleRemarks(const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_TIME_SCALE_H_
