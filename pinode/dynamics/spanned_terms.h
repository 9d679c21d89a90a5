// Finds the unknown stiffness and damping that a network could replace.

#ifndef PINODE_DYNAMICS_SPANNED_TERMS_H_
#define PINODE_DYNAMICS_SPANNED_TERMS_H_

#include <string>
#include <vector>

#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Returns the names of free stiffness and damping groups, and of linear
// elements with a free stiffness or damper, that `network` could replace: its
// inputs span them and its outputs share their forces. Without the gauge the
// data could not separate their values from the network's slope at rest
// (NetworkArchitecture::gauge). `network` need not be a term of `dynamics` yet,
// but its features and outputs must fit it.
std::vector<std::string> SpannedTerms(const StructuralDynamics& dynamics,
                                      const NetworkTerm& network);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_SPANNED_TERMS_H_
