// Scan for the initial time of a pulse.

#ifndef PINODE_ESTIMATE_FIT_PULSE_SCAN_H_
#define PINODE_ESTIMATE_FIT_PULSE_SCAN_H_

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Replaces *parameters (all of the problem's) by the pulses that fit the
// training records best, or keeps the given values if nothing is better. A
// search by derivatives finds a pulse only from a start that overlaps it. The
// misfit has a minimum at every period of the response, and none if the pulse
// lies after it. Therefore each half-sine pulse with a free start is tried
// every seventh of its duration, over the bounds of the start as far as the
// training records go. If the duration is free, five durations around the given
// one are tried. Each trial has the amplitude that fits best. Several pulses
// are found one after the other.
void ScanPulses(const IdentificationProblem& problem, Vector* parameters);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_PULSE_SCAN_H_
