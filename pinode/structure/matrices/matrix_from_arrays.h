// Builds matrices and DOF names from the arrays of other programs.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_FROM_ARRAYS_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_FROM_ARRAYS_H_

#include <string>
#include <vector>

#include "pinode/base/arrays/numpy_array.h"
#include "pinode/base/types.h"
#include "pinode/structure/matrices/matrix_container.h"

namespace pinode {

// A sparse matrix as SciPy stores it. COO: entry k of `data` has row indices[k]
// and column columns[k]. CSR: it has row i and column indices[k] for
// pointers[i] <= k < pointers[i + 1]. CSC: rows and columns are exchanged.
struct SparseParts {
  const NumpyArray* data = nullptr;
  const NumpyArray* indices = nullptr;
  const NumpyArray* pointers = nullptr;  // null for COO
  const NumpyArray* columns = nullptr;   // COO only
  const NumpyArray* shape = nullptr;
  bool by_columns = false;  // CSC
};

// Builds a matrix from its parts. Each function here checks sizes, indices and
// numbers. It returns false with a sentence in *what that continues "array 'x'
// ...".
[[nodiscard]] bool MatrixFromParts(const SparseParts& parts,
                                   SparseMatrix* matrix, std::string* what);

// Builds a matrix from an array of two dimensions. Zeros are not stored.
[[nodiscard]] bool MatrixFromFullArray(const NumpyArray& array,
                                       SparseMatrix* matrix, std::string* what);

// Reads names from a list of texts, or of pairs (node, direction), "12.3".
[[nodiscard]] bool NamesFromArray(const NumpyArray& array,
                                  std::vector<std::string>* names,
                                  std::string* what);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_FROM_ARRAYS_H_
