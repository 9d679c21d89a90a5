// Matrix Market files (R. F. Boisvert, R. Pozo, K. A. Remington, "The Matrix
// Market exchange formats: initial design", NISTIR 5935, 1996). Matrices may be
// coordinate or array, real or integer, general or symmetric. Other kinds
// (pattern, complex, skew-symmetric, hermitian) are refused, and so are entries
// that occur twice.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_MARKET_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_MARKET_H_

#include <string>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Reads a matrix of at most kMaxFiniteElementDofs rows and columns. For a
// symmetric file *matrix gets both triangles; the file's entries may lie in
// either. Zeros of a coordinate file stay as stored entries. On failure returns
// false, *matrix is unchanged, and *error is `file:line: error, expected ...`.
[[nodiscard]] bool ReadMatrixMarket(const std::string& path,
                                    SparseMatrix* matrix, std::string* error);

// Reads a matrix from `content`, for at most `max_dimension` rows and columns.
// `path` is the name of the file in messages. Otherwise as ReadMatrixMarket.
[[nodiscard]] bool ReadMatrixMarketText(const std::string& path,
                                        const std::string& content,
                                        int max_dimension, SparseMatrix* matrix,
                                        std::string* error);

// Writes a coordinate file with 17 significant digits, so that reading it gives
// the same bits. A matrix that equals its transpose is written as its lower
// triangle (symmetric), any other completely (general). The file is written
// completely or not at all. Returns false, with *error, if an entry is not
// finite or the file cannot be written. Aborts if the matrix has no rows or no
// columns.
[[nodiscard]] bool WriteMatrixMarket(const std::string& path,
                                     const SparseMatrix& matrix,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_MARKET_H_
