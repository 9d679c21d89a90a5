// What a fit has come to, as a summary and a model.

#ifndef PINODE_ESTIMATE_FIT_OUTCOME_H_
#define PINODE_ESTIMATE_FIT_OUTCOME_H_

#include "pinode/estimate/fit/fit.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Covariance at the fit's best point; scores of every record, run freely from
// its start, and of every mode, each beside those of the model before; the
// parameters' intervals and the forces' bands. Leaves alone what the fit's own
// summary holds already: iterations, stages, gaps.
void ReportOutcome(const IdentificationProblem& problem,
                   const IdentificationOptions& options, Fit* fit,
                   FitSummary* summary, IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_OUTCOME_H_
