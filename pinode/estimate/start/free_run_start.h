// Start of a record's simulation.

#ifndef PINODE_ESTIMATE_START_FREE_RUN_START_H_
#define PINODE_ESTIMATE_START_FREE_RUN_START_H_

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Finds the state from which a record's simulation starts: at rest or as known.
// A free start with periodic excitation is the model's steady state, which uses
// no sample. Any other free start is smoothed, given the parameters, from the
// first samples alone. Returns the first sample that may be scored: 0, or in a
// hold-out the first one after those used. sigmas: noise per channel.
Eigen::Index FreeRunStart(const IdentificationProblem& problem, int record,
                          const Vector& parameters, const Vector& sigmas,
                          Vector* start);

// Finds the state at the first sample that a period of the record's excitation
// reproduces, to 1e-9 of each state's RMS. Uses Newton's method on the map of a
// period, or plain repetition of the period if that does not help. Returns
// false if a run is not finite, or the state still changes after many periods;
// *start is then the last finite one. `parameters`: all of the problem's.
[[nodiscard]] bool FindSteadyState(const IdentificationProblem& problem,
                                   int record, const Vector& parameters,
                                   Vector* start);

// Makes the start of training records with a free start and `start_samples`
// known. The start is estimated from these samples with the model's initial
// parameters. It is no longer an unknown of the fit. This is for devices
// without a spring: a wrong initial velocity makes their motion drift, and a
// fit to whole records would choose the start to compensate for the model's
// errors.
void FixTrainingStarts(IdentificationProblem* problem);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_FREE_RUN_START_H_
