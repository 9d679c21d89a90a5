// Initial model for the fit of ambient records.

#ifndef PINODE_ESTIMATE_FIT_AMBIENT_START_H_
#define PINODE_ESTIMATE_FIT_AMBIENT_START_H_

#include <functional>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Finds an initial model from the modes of ambient records. The likelihood of a
// spectrum has narrow peaks: a frequency that is wrong by more than a few
// bandwidths is not drawn to its place. Therefore the modes of the records,
// which need no model (pinode/modal), are fitted first.
//
// `fit` fits them: a problem of measured modes alone, from its own values.
//
// Returns false, with *model untouched, if this start does not apply: there is
// no ambient record, the fit can begin with other data as well, or the modes
// and the model have nothing in common.
using FitOfModes = std::function<void(
    const IdentificationProblem& problem, const IdentificationOptions& options,
    FitSummary* summary, IdentifiedModel* model)>;
[[nodiscard]] bool StartFromAmbientModes(const IdentificationProblem& problem,
                                         const IdentificationOptions& options,
                                         const FitOfModes& fit,
                                         IdentifiedModel* model);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_FIT_AMBIENT_START_H_
