// Reads matrices from files and writes them to files.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_IO_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_IO_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {

// Largest number of rows or columns of the dense matrices here. Larger ones are
// refused before any allocation: a wrong size line must not exhaust the memory.
inline constexpr int kMaxMatrixDimension = 10000;

// Reads a matrix from a file. The format follows from the extension:
//
//   .csv  One row per line, entries separated by commas, semicolons or blanks.
//         Blank lines and lines that begin with # are skipped.
//   .mtx  Matrix Market, coordinate or array, real or integer, general or
//         symmetric (R. F. Boisvert, R. Pozo, K. A. Remington, "The Matrix
//         Market exchange formats: initial design", NISTIR 5935, 1996). The
//         entries of a symmetric coordinate file may lie in either triangle.
//   .matrix .hb .rb .rsa .rua  Harwell-Boeing (harwell_boeing.h).
//
// Numbers have a decimal point in every locale. Fortran's exponent D is
// accepted. On failure *matrix is unchanged and *error is `file:line: error,
// expected ...`.
[[nodiscard]] bool ReadMatrix(const std::string& path, Matrix* matrix,
                              std::string* error);

// Writes a Matrix Market coordinate file with 17 significant digits, so that
// reading it gives the same bits. A matrix that equals its transpose is written
// as its lower triangle (symmetric), any other as all its non-zeros (general).
// The file is written completely or not at all. Fails if an entry is not finite
// or the file cannot be written.
[[nodiscard]] bool WriteMatrixMarket(const std::string& path,
                                     const Matrix& matrix, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_IO_H_
