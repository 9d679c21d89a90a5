// Polarity of sensors and load cells.

#ifndef PINODE_ESTIMATE_START_SIGNS_H_
#define PINODE_ESTIMATE_START_SIGNS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Signs are read before a fit from the model's own response to the measured
// excitation. The response uses the matrices at the initial values, with every
// mode damped to 0.15 of critical, without elements and networks, from rest.
// Response and record are compared by phase. With the spectra Y and P of the
// measurement and of the response, both without their means,
//
//   agreement = sum_f w_f cos(phase of Y_f - phase of P_f) / sum_f w_f,
//   w_f = sqrt(|Y_f| |P_f|),
//
// from -1 to 1. Between a resonance of the structure and that of the model the
// two have opposite phases, elsewhere the same. The correlation in time,
// weighted by |Y_f| |P_f|, is dominated by the resonances. It is random if one
// of them is wrong by more than its half-power width.

// Gives the free gains of sensors and the free scales of forces in *parameters
// (all of the problem's) the sign that the training records show; their sizes
// stay. A sign is unknown if the bounds allow both signs and there is no prior.
// Scales come first, by least squares over all channels whose gain has a known
// sign. Then each gain follows its channel's agreement with the response. If
// the agreement is below 0.25 in size, the sign stays.
void FindSigns(const IdentificationProblem& problem, Vector* parameters);

// Returns remarks on signs for the user, one sentence each. `parameters` are
// those found (or those that a fit would begin with). The remarks cover:
//
// - gains and scales whose sign is not that of the initial value;
// - delays found equal at all sensors (within a tenth, half a sample or more);
// - channels of known sign that clearly oppose the response (an agreement below
//   -0.4), as a sensor that is mounted upside down;
// - pairs of channels that clearly agree with each other's response (0.5) and
//   not with their own (0.25), as sensors whose axes or cables are exchanged.
//
// Forces of prescribed motions are left out: this model does not determine the
// resistance of a device.
std::vector<std::string> SignRemarks(const IdentificationProblem& problem,
                                     const Vector& parameters);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_SIGNS_H_
