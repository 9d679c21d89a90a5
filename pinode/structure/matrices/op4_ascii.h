// Reads OUTPUT4 in text: fixed columns, as Fortran writes them.

#ifndef PINODE_STRUCTURE_MATRICES_OP4_ASCII_H_
#define PINODE_STRUCTURE_MATRICES_OP4_ASCII_H_

#include <string>

#include "pinode/structure/matrices/matrix_container.h"

namespace pinode {

// Adds the matrices in `content`, text of the file `path`, to the container:
// dense, sparse or BIGMAT, in the format that their headers state. Returns
// false if the text does not follow Nastran's format. *error names the line.
[[nodiscard]] bool ReadOp4Ascii(const std::string& path,
                                const std::string& content,
                                MatrixContainer* container, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_OP4_ASCII_H_
