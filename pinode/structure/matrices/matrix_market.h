// Matrix Market files (R. F. Boisvert, R. Pozo, K. A. Remington, "The Matrix
// Market exchange formats: initial design", NISTIR 5935, 1996): coordinate or
// array, real or integer, general or symmetric. What says nothing about the
// values (pattern) or cannot be mass, damping or stiffness (complex, skew-
// symmetric, hermitian) is refused, and so are entries given twice.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_MARKET_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_MARKET_H_

#include <string>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Reads a matrix of at most kMaxFiniteElementDofs rows and columns; both
// triangles of a symmetric file, whose entries may lie in either. Zeros that a
// coordinate file states stay in the sparsity. On failure *matrix is untouched
// and *error reads `file:line: what, and what was expected`.
[[nodiscard]] bool ReadMatrixMarket(const std::string& path,
                                    SparseMatrix* matrix, std::string* error);

// The same from the content of the file `path`, for at most `max_dimension`
// rows and columns.
[[nodiscard]] bool ReadMatrixMarketText(const std::string& path,
                                        const std::string& content,
                                        int max_dimension, SparseMatrix* matrix,
                                        std::string* error);

// Writes a coordinate file with 17 significant digits, so that reading it gives
// the same bits in the same places: of a matrix that equals its transpose the
// lower triangle (symmetric), of any other all (general). The file appears
// whole or not at all. Fails if an entry is not finite or the file cannot be
// written.
[[nodiscard]] bool WriteMatrixMarket(const std::string& path,
                                     const SparseMatrix& matrix,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_MARKET_H_
