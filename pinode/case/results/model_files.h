// The identified structure as matrices and networks on disk.

#ifndef PINODE_CASE_RESULTS_MODEL_FILES_H_
#define PINODE_CASE_RESULTS_MODEL_FILES_H_

#include <string>

#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Writes to `folder` M.mtx, C.mtx and K.mtx of `dynamics`, corrected by the
// groups that follow no covariate at their values in it. Also writes
// network_<name>.json of each network with its weights.
[[nodiscard]] bool WriteModelFiles(const StructuralDynamics& dynamics,
                                   const std::string& folder,
                                   std::string* error);

// Returns the name of the file of a network's weights.
std::string NetworkFileName(const NetworkTerm& term);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_MODEL_FILES_H_
