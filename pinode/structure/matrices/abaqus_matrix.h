// Reads the matrices that Abaqus writes as text with *MATRIX GENERATE and
// *MATRIX OUTPUT (FORMAT=MATRIX INPUT, the default): job_STIF2.mtx,
// job_MASS2.mtx, job_DMPV2.mtx.

#ifndef PINODE_STRUCTURE_MATRICES_ABAQUS_MATRIX_H_
#define PINODE_STRUCTURE_MATRICES_ABAQUS_MATRIX_H_

#include <string>

#include "pinode/structure/matrices/dof_matrix.h"

namespace pinode {

// Reads lines `node, direction, node, direction, value`. Skips comments, which
// begin with **, and keyword lines (*MATRIX, ...). As for CalculiX, the file
// holds one triangle or both. On failure *matrix is unchanged and *error is
// `file:line: error, expected ...`.
[[nodiscard]] bool ReadAbaqusMatrix(const std::string& path, DofMatrix* matrix,
                                    std::string* error);

// Does the same with the content of the file `path`.
[[nodiscard]] bool ReadAbaqusMatrixText(const std::string& path,
                                        const std::string& content,
                                        DofMatrix* matrix, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_ABAQUS_MATRIX_H_
