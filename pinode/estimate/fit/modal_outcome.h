// What a fit says of measured modes, and they of it.

#ifndef PINODE_ESTIMATE_FIT_MODAL_OUTCOME_H_
#define PINODE_ESTIMATE_FIT_MODAL_OUTCOME_H_

#include "pinode/base/types.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Notes modes and modal costs of the models before and after, and which modes
// the fit did not use. `parameters`: all of the layout, after the fit; `modes`:
// its cost.
//
// Where modes are all that is fitted, what is left over of them scales
// `covariance` (and `known` says whether there is one): always where they have
// no standard deviations, and where they have, if the rest is larger than
// chance (1 %) would make it. They say what the measurement left open, and the
// model's own errors come on top (R. T. Birge, Phys. Rev. 40 (1932) 207-227).
void ReportModes(const IdentificationProblem& problem,
                 const ParameterLayout& layout, const Vector& parameters,
                 ModalCost* modes, bool* known, CovarianceEstimate* covariance,
                 FitSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_MODAL_OUTCOME_H_
