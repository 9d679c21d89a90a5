// Matrices and DOF names from the arrays of other programs.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_FROM_ARRAYS_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_FROM_ARRAYS_H_

#include <string>
#include <vector>

#include "pinode/base/arrays/numpy_array.h"
#include "pinode/base/types.h"
#include "pinode/structure/matrices/matrix_container.h"

namespace pinode {

// A sparse matrix as SciPy holds it: entry k of `data` stands in row indices[k]
// and column columns[k] (COO); or in row i and column indices[k] for
// pointers[i] <= k < pointers[i + 1] (CSR), in CSC the other way round.
struct SparseParts {
  const NumpyArray* data = nullptr;
  const NumpyArray* indices = nullptr;
  const NumpyArray* pointers = nullptr;  // null for COO
  const NumpyArray* columns = nullptr;   // COO only
  const NumpyArray* shape = nullptr;
  bool by_columns = false;  // CSC
};

// Each checks sizes, indices and numbers. False with a sentence in *what that
// continues "array 'x' ...".
[[nodiscard]] bool MatrixFromParts(const SparseParts& parts,
                                   SparseMatrix* matrix, std::string* what);

// From an array of two dimensions; zeros are no entries.
[[nodiscard]] bool MatrixFromFullArray(const NumpyArray& array,
                                       SparseMatrix* matrix, std::string* what);

// From a list of texts, or of pairs (node, direction), "12.3".
[[nodiscard]] bool NamesFromArray(const NumpyArray& array,
                                  std::vector<std::string>* names,
                                  std::string* what);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_FROM_ARRAYS_H_
