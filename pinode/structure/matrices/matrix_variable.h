// Reads one matrix, by name, from a file that holds several.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_VARIABLE_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_VARIABLE_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {

// Returns true if files with this extension hold matrices by name: .mat
// (MATLAB), .npz (NumPy), .op4 (Nastran).
bool HoldsMatricesByName(const std::string& path);

// Reads the matrix `variable` of such a file, sparse or full. If no name
// matches exactly, the case of letters is ignored. If `variable` is empty,
// reads the only matrix. Refuses matrices that are too large for ReadMatrix. On
// failure *matrix is unchanged and *error begins with the path.
[[nodiscard]] bool ReadMatrixVariable(const std::string& path,
                                      const std::string& variable,
                                      Matrix* matrix, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_VARIABLE_H_
