// One matrix by name, of a file that holds several.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_VARIABLE_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_VARIABLE_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {

// Whether a file of this name holds matrices by name: .mat (MATLAB), .npz
// (NumPy), .op4 (Nastran).
bool HoldsMatricesByName(const std::string& path);

// Reads the matrix `variable` of such a file, sparse or full, in any case of
// letters where none is called exactly so; empty: its only one. Larger ones
// than ReadMatrix reads are refused. On failure *matrix is untouched and *error
// begins with the path.
[[nodiscard]] bool ReadMatrixVariable(const std::string& path,
                                      const std::string& variable,
                                      Matrix* matrix, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_VARIABLE_H_
