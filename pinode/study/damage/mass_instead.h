// Masses in place of changes that measured modes show. Not meant for other
// layers.

#ifndef PINODE_STUDY_DAMAGE_MASS_INSTEAD_H_
#define PINODE_STUDY_DAMAGE_MASS_INSTEAD_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/problem/inner_fit.h"

namespace pinode {

// Returns the mass that explains new modes about as well as changes of groups
// do, such as "the mass at u5, +18.2 (16.3 to 20.1) %", or an empty text if
// none does. Frequencies and shapes of few modes do not tell an added mass from
// a loss of stiffness.
//
// Two fits are compared for each mass: with the groups `changed` free, and with
// the mass free. In both, all other groups have the values of the baselines,
// `healthy`, as priors. A mass counts unless its fit has less than a twentieth
// of the likelihood of the other one. `problem` is of modes alone (IsOfModes),
// and `model` is its fit. `groups`: their names in the order of `healthy`.
// `changed` has the values with which the fit of the changed groups begins:
// with all groups free, the modes may be those of other groups, such as mirror
// images.
std::string MassInstead(const IdentificationProblem& problem,
                        const IdentificationOptions& options,
                        const IdentifiedModel& model,
                        const std::vector<std::string>& groups,
                        const std::vector<GroupState>& healthy,
                        const std::map<std::string, double>& changed,
                        InnerFit* inner);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_MASS_INSTEAD_H_
