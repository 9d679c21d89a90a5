// Which way round sensors and load cells are mounted.

#ifndef PINODE_ESTIMATE_START_SIGNS_H_
#define PINODE_ESTIMATE_START_SIGNS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Before a fit signs are read off from the model's own response to the measured
// excitation: its matrices at the initial values, every mode damped to 0.15 of
// critical, without elements and networks, from rest. Response and record are
// compared by their phase: with the spectra Y and P of what was measured and of
// the response, both over the mean,
//
//   agreement = sum_f w_f cos(phase of Y_f - phase of P_f) / sum_f w_f,
//   w_f = sqrt(|Y_f| |P_f|),
//
// from -1 to 1. Between a resonance of the structure and the model's the two go
// against each other, elsewhere along. The correlation in time, weighted by
// |Y_f| |P_f|, sees little but the resonances, and is chance where one of them
// is off by more than its half-power width.

// Gives the free gains of sensors and the free scales of forces in *parameters
// (all of the problem's) the sign that the training records show; their sizes
// stay. Those have one to be found that can be of either sign by their bounds
// and have no prior. Scales come first, by least squares over all channels
// whose gain has a known sign, then each gain by its channel's agreement with
// the response. Where the agreement is below 0.25 in size the sign stays as it
// is.
void FindSigns(const IdentificationProblem& problem, Vector* parameters);

// What a user should hear of signs, a sentence each, `parameters` being those
// found (or those that a fit would begin with): gains and scales whose sign is
// not that of the initial value, delays that were found alike at all sensors
// (within a tenth, half a sample or more), and channels of known sign that
// clearly go against the response (an agreement below -0.4), as a sensor does
// that is mounted upside down. Forces of prescribed motions are left out: what
// a device resists with is not this model's to say.
std::vector<std::string> SignRemarks(const IdentificationProblem& problem,
                                     const Vector& parameters);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_SIGNS_H_
