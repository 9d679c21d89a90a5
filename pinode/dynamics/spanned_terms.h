// Which unknown stiffness and damping a network could stand in for.

#ifndef PINODE_DYNAMICS_SPANNED_TERMS_H_
#define PINODE_DYNAMICS_SPANNED_TERMS_H_

#include <string>
#include <vector>

#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// The free stiffness and damping groups, and linear elements with a free
// stiffness or damper, that the inputs of `network` span and whose forces its
// outputs share: without the gauge their values could not be told from the
// network's slope at rest (NetworkArchitecture::gauge). `network` need not be a
// term of `dynamics` yet; its features and outputs fit it.
std::vector<std::string> SpannedTerms(const StructuralDynamics& dynamics,
                                      const NetworkTerm& network);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_SPANNED_TERMS_H_
