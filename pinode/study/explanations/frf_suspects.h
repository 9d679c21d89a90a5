// Sensors and forces of frequency responses that may be wrong.

#ifndef PINODE_STUDY_EXPLANATIONS_FRF_SUSPECTS_H_
#define PINODE_STUDY_EXPLANATIONS_FRF_SUSPECTS_H_

#include <vector>

#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

// Returns gains and delays of single sensors and of all of them (or of the
// hammer), and the places that describe the functions better if they are
// swapped or turned round, best first, `most` of each kind. A change T of the
// measured functions h gains
//
//   sum over lines of  Re(h' T' f) - Re(h' f)
//
// relative to their sizes, with f of the model. A fit adapts to a fault, so the
// gain is the larger one of those at the fit and at the initial values. Swapped
// places are not sought among more than 500.
std::vector<Suspect> MakeFrfSuspects(const IdentificationProblem& problem,
                                     const IdentifiedModel& model, size_t most);

// Applies the changes of the functions' places to *problem.
void ChangeFrfs(const std::vector<Suspect::FrfChange>& changes,
                IdentificationProblem* problem);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_FRF_SUSPECTS_H_
