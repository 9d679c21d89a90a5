// Results of a fit, as a summary and a model.

#ifndef PINODE_ESTIMATE_FIT_OUTCOME_H_
#define PINODE_ESTIMATE_FIT_OUTCOME_H_

#include "pinode/estimate/fit/fit.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Reports how the fit ended, the covariance at its best point, the parameters'
// intervals and the forces' bands. Scores every record, simulated from its
// start, and every mode, each compared with the initial model. Leaves the
// fields that the fit's own summary already holds: iterations, stages, gaps.
void ReportOutcome(const IdentificationProblem& problem,
                   const IdentificationOptions& options, Fit* fit,
                   FitSummary* summary, IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_OUTCOME_H_
