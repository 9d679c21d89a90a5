// Checks of a fit against what its problem says of sensors and unknowns.

#ifndef PINODE_STUDY_EXPLANATIONS_RECORD_CHECKS_H_
#define PINODE_STUDY_EXPLANATIONS_RECORD_CHECKS_H_

#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/verdict.h"

namespace pinode {

// Returns a finding where
//
// - two fitted channels of a record hold the same values, but should measure
//   different motions;
// - the residuals of a channel are far larger than its given noise;
// - an unknown is more than four deviations of its prior away from it;
// - a stiffness or mass group has become several times what the model has;
// - a mode has become strongly damped, or the damping matrix drives a motion.
std::vector<Finding> CheckAgainstProblem(const IdentificationProblem& problem,
                                         const FitSummary& fit,
                                         const IdentifiedModel& model);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_RECORD_CHECKS_H_
