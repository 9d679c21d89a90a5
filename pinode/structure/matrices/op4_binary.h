// OUTPUT4 in Fortran's unformatted records.

#ifndef PINODE_STRUCTURE_MATRICES_OP4_BINARY_H_
#define PINODE_STRUCTURE_MATRICES_OP4_BINARY_H_

#include <string>

#include "pinode/structure/matrices/matrix_container.h"

namespace pinode {

// Whether `content` begins with the record of a matrix' header, in either byte
// order, of 32- or 64-bit integers and with record lengths of either.
bool IsOp4Binary(const std::string& content);

// Adds the matrices in `content`, for which IsOp4Binary, to the container.
// There are no lines: *error names the matrix and the column, or the byte.
[[nodiscard]] bool ReadOp4Binary(const std::string& path,
                                 const std::string& content,
                                 MatrixContainer* container,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_OP4_BINARY_H_
