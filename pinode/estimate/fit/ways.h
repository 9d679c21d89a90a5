// The ways from one start to a solution.

#ifndef PINODE_ESTIMATE_FIT_WAYS_H_
#define PINODE_ESTIMATE_FIT_WAYS_H_

#include <memory>

#include "pinode/base/types.h"
#include "pinode/estimate/fit/fit.h"

namespace pinode {

// A problem with the same parameters of which laws and networks are not free:
// laws are as they are, networks have no effect. nullptr: that is the problem
// itself, or nothing would be free.
std::unique_ptr<IdentificationProblem> LinearPart(
    const IdentificationProblem& problem);

// Solves from `parameters` (all of the problem's) and returns the fit that
// predicts best, nullptr with the message in *summary where nothing finite came
// out. *summary is that of the fit, with `way` and `linear_error`.
//
// Where there are laws to be found, terms enter in order: first what is linear,
// on whole records or, where that leads nowhere, by stages of multiple
// shooting; then all, on whole records. That ends it where what is left over is
// noise, or less than a hundredth of the records. Where it is not, the stages
// of multiple shooting of everything at once are a second way; it is left off
// where it has done three times the work of the first and has not come to an
// end.
//
// Linear models, of nothing but groups, are fitted on whole records, and by the
// stages as well where more than noise is left over.
//
// Networks are trained by their stages. Only where the result is poor is the
// linear part fitted, and training begins again from what it found where that
// was better.
//
// Who gives `initial` (may be nullptr) or asks for single shooting has chosen
// the way.
std::unique_ptr<Fit> RunWays(const IdentificationProblem& problem,
                             const IdentificationOptions& options,
                             const Vector& parameters,
                             const IdentifiedModel* initial,
                             FitSummary* summary);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_WAYS_H_
