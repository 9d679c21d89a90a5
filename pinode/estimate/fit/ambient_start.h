// Initial model for the fit of ambient records.

#ifndef PINODE_ESTIMATE_FIT_AMBIENT_START_H_
#define PINODE_ESTIMATE_FIT_AMBIENT_START_H_

#include "pinode/problem/identification_problem.h"

namespace pinode {

// Makes a problem of measured modes alone, whose fit is the initial model for
// the ambient records of `problem`. The likelihood of a spectrum has narrow
// peaks: a frequency that is wrong by more than a few bandwidths is not drawn
// to its place. The modes of the records need no model (pinode/modal).
//
// Returns false if this start does not apply: there is no ambient record, the
// fit can begin with other data as well, or the modes and the model have
// nothing in common. *modes_alone is new.
[[nodiscard]] bool ModesOfAmbientRecord(const IdentificationProblem& problem,
                                        int num_threads,
                                        IdentificationProblem* modes_alone);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_AMBIENT_START_H_
