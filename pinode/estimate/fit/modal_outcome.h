// Results of a fit for modes: measured ones, and those of its matrices.

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

// Returns the least damping ratio of the matrices' modes at `parameters` (all
// of the problem's), at the reference of the covariates. With ambient records
// alone it is at the covariates of these. NaN if no mode has one.
double LeastDamping(const IdentificationProblem& problem,
                    const Vector& parameters);

// True if free dampings have given lower bounds.
bool DampingsAreBounded(const StructuralDynamics& dynamics);

// Looks at the matrices of `problem` at `parameters` (all of the problem's). If
// a motion grows by more than limits::kGrowth e-folds over the longest record,
// sets summary->growing_motion to a sentence such as "a motion at 10.98 Hz has
// negative damping in the matrices found", and the advice beside it.
void ReportGrowingMotion(const IdentificationProblem& problem,
                         const Vector& parameters, FitSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_MODAL_OUTCOME_H_
