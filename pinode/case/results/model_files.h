// The identified structure as matrices and networks on disk.

#ifndef PINODE_CASE_RESULTS_MODEL_FILES_H_
#define PINODE_CASE_RESULTS_MODEL_FILES_H_

#include <string>

#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Writes to `folder` M.mtx, C.mtx and K.mtx, those of `dynamics` corrected by
// the groups that follow nothing at the values that they have in it, and of
// each network network_<name>.json with its weights.
[[nodiscard]] bool WriteModelFiles(const StructuralDynamics& dynamics,
                                   const std::string& folder,
                                   std::string* error);

// What WriteModelFiles calls the file of a network's weights.
std::string NetworkFileName(const NetworkTerm& term);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_MODEL_FILES_H_
