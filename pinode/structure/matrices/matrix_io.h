// Matrices from and to files.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_IO_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_IO_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {

// Matrices here are dense, and larger ones are refused before anything is
// allocated: a wrong size line must not take the machine's memory.
inline constexpr int kMaxMatrixDimension = 10000;

// Reads a matrix from a file, by its extension:
//
//   .csv  One row a line, entries separated by commas, semicolons or blanks.
//         Blank lines and lines that begin with # are skipped.
//   .mtx  Matrix Market, coordinate or array, real or integer, general or
//         symmetric (R. F. Boisvert, R. Pozo, K. A. Remington, "The Matrix
//         Market exchange formats: initial design", NISTIR 5935, 1996). The
//         entries of a symmetric coordinate file may lie in either triangle.
//
// Numbers have a decimal point whatever the locale; Fortran's exponent D is
// understood. On failure *matrix is untouched and *error reads `file:line:
// what, and what was expected`.
[[nodiscard]] bool ReadMatrix(const std::string& path, Matrix* matrix,
                              std::string* error);

// Writes a Matrix Market coordinate file with 17 significant digits, so that
// reading it gives the same bits: of a matrix that equals its transpose the
// lower triangle (symmetric), of any other all non-zeros (general). The file
// appears whole or not at all. Fails if an entry is not finite or the file
// cannot be written.
[[nodiscard]] bool WriteMatrixMarket(const std::string& path,
                                     const Matrix& matrix, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_IO_H_
