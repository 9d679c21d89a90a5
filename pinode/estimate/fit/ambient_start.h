// Start of the fit of ambient records.

#ifndef PINODE_ESTIMATE_FIT_AMBIENT_START_H_
#define PINODE_ESTIMATE_FIT_AMBIENT_START_H_

#include <functional>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// The likelihood of a spectrum has narrow peaks: where a frequency is off by
// more than a few bandwidths nothing draws it to its place. So the modes of the
// records, which need no model (pinode/modal), are fitted first.
//
// `fit` fits them: a problem of measured modes alone, from its own values.
//
// False, with *model untouched, where that is not how to begin: there is no
// ambient record, or something else as well that the fit can begin with; or the
// modes and the model have nothing in common.
using FitOfModes = std::function<void(
    const IdentificationProblem& problem, const IdentificationOptions& options,
    FitSummary* summary, IdentifiedModel* model)>;
[[nodiscard]] bool StartFromAmbientModes(const IdentificationProblem& problem,
                                         const IdentificationOptions& options,
                                         const FitOfModes& fit,
                                         IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_AMBIENT_START_H_
