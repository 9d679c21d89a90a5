// Reads OUTPUT4 in Fortran's unformatted records.

#ifndef PINODE_STRUCTURE_MATRICES_OP4_BINARY_H_
#define PINODE_STRUCTURE_MATRICES_OP4_BINARY_H_

#include <string>

#include "pinode/structure/matrices/matrix_container.h"

namespace pinode {

// Returns true if `content` begins with the record of a matrix header: in
// either byte order, with 32- or 64-bit integers, and with record lengths of 32
// or 64 bits.
bool IsOp4Binary(const std::string& content);

// Adds the matrices in `content` to the container. IsOp4Binary must be true.
// *error names the matrix and the column, or the byte, because there are no
// lines.
[[nodiscard]] bool ReadOp4Binary(const std::string& path,
                                 const std::string& content,
                                 MatrixContainer* container,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_OP4_BINARY_H_
