// Where the free run of a record begins.

#ifndef PINODE_ESTIMATE_START_FREE_RUN_START_H_
#define PINODE_ESTIMATE_START_FREE_RUN_START_H_

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// The state from which a record's free run starts: at rest or as known; for a
// free start, where the excitation is periodic, the model's steady state, which
// needs no sample, and else smoothed, given the parameters, from the first
// samples alone. Returns the first sample that may be scored: 0, or of a
// hold-out the first one after those used. sigmas: noise per channel.
Eigen::Index FreeRunStart(const IdentificationProblem& problem, int record,
                          const Vector& parameters, const Vector& sigmas,
                          Vector* start);

// The state at the first sample with which a period of the record's excitation
// ends as it began, to 1e-9 of each state's RMS: Newton's method on the map of
// a period, plain repetition of the period where that does not help. False
// where a run is not finite, or the state still changes after many periods;
// *start is then the last one that was finite. `parameters`: all of the
// problem's.
[[nodiscard]] bool FindSteadyState(const IdentificationProblem& problem,
                                   int record, const Vector& parameters,
                                   Vector* start);

// Gives the training records with a free start and `start_samples` the start
// that these samples say, on the model as it is: what is then an unknown no
// more. For devices without a spring, whose motion a wrong velocity of the
// start carries away, and which whole records would choose so that it makes up
// for what the model lacks.
void FixTrainingStarts(IdentificationProblem* problem);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_FREE_RUN_START_H_
