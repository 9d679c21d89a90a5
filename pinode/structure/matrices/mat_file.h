// Reads MATLAB files with matio: version 5 (compressed or not) and 7.3 (HDF5).

#ifndef PINODE_STRUCTURE_MATRICES_MAT_FILE_H_
#define PINODE_STRUCTURE_MATRICES_MAT_FILE_H_

#include <string>

#include "pinode/structure/matrices/matrix_container.h"

namespace pinode {

// Reads the matrices of a .mat file, sparse or full, of any real type. A
// variable `dofs` (or `dof_names`, `dof_map`) names the rows: a cell array of
// strings, a character array with a name in each row, or pairs (node,
// direction). Other variables are ignored. On failure *container is unchanged.
[[nodiscard]] bool ReadMatFile(const std::string& path,
                               MatrixContainer* container, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MAT_FILE_H_
