// Where a pulse of unknown time is looked for first.

#ifndef PINODE_ESTIMATE_FIT_PULSE_SCAN_H_
#define PINODE_ESTIMATE_FIT_PULSE_SCAN_H_

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// A search by derivatives finds a pulse only from a start that meets it: the
// misfit has a minimum at every period of the response, and none at all where
// the pulse lies behind it. Each half-sine pulse whose start is free is
// therefore tried every seventh of its duration, over the bounds of the start
// as far as the training records go, with five durations around the given one
// where that is free, each with the amplitude that suits best. What fits the
// training records best, or what is given where nothing does better, replaces
// *parameters (all of the problem's). Several pulses are looked for one after
// the other.
void ScanPulses(const IdentificationProblem& problem, Vector* parameters);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_PULSE_SCAN_H_
