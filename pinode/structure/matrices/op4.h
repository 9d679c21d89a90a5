// Reads Nastran's OUTPUT4 files (MSC Nastran DMAP Programmer's Guide, OUTPUT4).

#ifndef PINODE_STRUCTURE_MATRICES_OP4_H_
#define PINODE_STRUCTURE_MATRICES_OP4_H_

#include <string>

#include "pinode/structure/matrices/matrix_container.h"

namespace pinode {

// Reads all matrices of an OP4 file: ASCII or binary (Fortran records, either
// byte order, 32- or 64-bit integers), dense, sparse or BIGMAT. Names are
// converted to lower case. OP4 has no DOF names. The binary format has no
// lines, so messages name the file, the matrix and the column. On failure
// *container is unchanged.
[[nodiscard]] bool ReadOp4(const std::string& path, MatrixContainer* container,
                           std::string* error);

// Does the same with the content of the file `path`.
[[nodiscard]] bool ReadOp4Content(const std::string& path,
                                  const std::string& content,
                                  MatrixContainer* container,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_OP4_H_
