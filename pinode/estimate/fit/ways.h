// Routes from one start to a solution.

#ifndef PINODE_ESTIMATE_FIT_WAYS_H_
#define PINODE_ESTIMATE_FIT_WAYS_H_

#include <memory>

#include "pinode/base/types.h"
#include "pinode/estimate/fit/fit.h"

namespace pinode {

// Returns a problem with the same parameters in which laws and networks are not
// free: laws keep their values, networks have no effect. Returns nullptr if
// that is the problem itself, or if nothing would be free.
std::unique_ptr<IdentificationProblem> LinearPart(
    const IdentificationProblem& problem);

// Solves from `parameters` (all of the problem's) and returns the fit with the
// best prediction; nullptr, with the message in *summary, if there is no finite
// result. *summary is that of the fit, with `way` and `linear_error`.
//
// With laws to be found, terms enter in order. The linear part is fitted first,
// on whole records or, if that fails, by stages of multiple shooting. Then all
// terms are fitted on whole records. This is the end if the remaining error is
// noise, or less than a hundredth of the records. Otherwise the stages of
// multiple shooting of all terms at once are a second route. It is abandoned
// after three times the work of the first route.
//
// Linear models, with groups only, are fitted on whole records, and also by the
// stages if more than noise remains.
//
// Networks are trained by their stages. Only if the result is poor is the
// linear part fitted. Training then begins again from the linear result if that
// was better.
//
// `initial` (may be nullptr) or single shooting fixes the route.
std::unique_ptr<Fit> RunWays(const IdentificationProblem& problem,
                             const IdentificationOptions& options,
                             const Vector& parameters,
                             const IdentifiedModel* initial,
                             FitSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_WAYS_H_
