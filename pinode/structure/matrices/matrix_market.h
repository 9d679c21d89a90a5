// Matrix Market files (R. F. Boisvert, R. Pozo, K. A. Remington, "The Matrix
// Market exchange formats: initial design", NISTIR 5935, 1996): coordinate or
// array, real or integer, general or symmetric. Refused are files without
// values (pattern) and files that cannot be mass, damping or stiffness
// (complex, skew-symmetric, hermitian). Entries given twice are refused too.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_MARKET_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_MARKET_H_

#include <string>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Reads a matrix of at most kMaxFiniteElementDofs rows and columns. Returns
// both triangles of a symmetric file, whose entries may lie in either. Explicit
// zeros of a coordinate file stay in the sparsity. On failure *matrix is
// unchanged and *error is `file:line: error, expected ...`.
[[nodiscard]] bool ReadMatrixMarket(const std::string& path,
                                    SparseMatrix* matrix, std::string* error);

// Does the same with the content of the file `path`, for at most
// `max_dimension` rows and columns.
[[nodiscard]] bool ReadMatrixMarketText(const std::string& path,
                                        const std::string& content,
                                        int max_dimension, SparseMatrix* matrix,
                                        std::string* error);

// Writes a coordinate file with 17 significant digits, so that reading it gives
// the same bits in the same places. A matrix that equals its transpose is
// written as its lower triangle (symmetric), any other completely (general).
// The file is written completely or not at all. Fails if an entry is not finite
// or the file cannot be written.
[[nodiscard]] bool WriteMatrixMarket(const std::string& path,
                                     const SparseMatrix& matrix,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_MARKET_H_
