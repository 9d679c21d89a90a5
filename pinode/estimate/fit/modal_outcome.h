// Results of a fit for measured modes.

#ifndef PINODE_ESTIMATE_FIT_MODAL_OUTCOME_H_
#define PINODE_ESTIMATE_FIT_MODAL_OUTCOME_H_

#include "pinode/base/types.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Records modes and modal costs of the initial and the fitted model, and the
// modes that the fit did not use. `parameters`: all of the layout, after the
// fit. `modes`: the modal cost of the fit.
//
// If only modes are fitted, their residuals scale `covariance` (`known` tells
// if there is one). They always do so without standard deviations. With
// standard deviations they do so if the residuals are larger than chance (1 %)
// would make them. The intervals then cover errors of the measurement; the
// model's own errors come on top (R. T. Birge, Phys. Rev. 40 (1932) 207-227).
void ReportModes(const IdentificationProblem& problem,
                 const ParameterLayout& layout, const Vector& parameters,
                 ModalCost* modes, bool* known, CovarianceEstimate* covariance,
                 FitSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_MODAL_OUTCOME_H_
