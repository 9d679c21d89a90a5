// NumPy archives (.npz): arrays in NumPy's own format in a zip file
// (numpy.lib.format, NEP 1).

#ifndef PINODE_STRUCTURE_MATRICES_NPZ_H_
#define PINODE_STRUCTURE_MATRICES_NPZ_H_

#include <string>

#include "pinode/structure/matrices/matrix_container.h"

namespace pinode {

// Reads the matrices of an archive written in one of these ways:
//
//   numpy.savez(f, M=..., C=..., K=..., dofs=...)    full arrays by name
//   scipy.sparse.save_npz(f, K)       one sparse matrix, CSR, CSC or COO; its
//                                     name here is empty
//   numpy.savez(f, K_data=..., K_indices=..., K_indptr=..., K_shape=..., ...)
//                                     CSR parts by name (for the symmetric
//                                     matrices of structures CSC is the same)
//   numpy.savez(f, K_data=..., K_row=..., K_col=..., K_shape=..., ...)    COO
//
// `dofs` (or `dof_names`, `dof_map`) is an array of names or of pairs (node,
// direction), one for each row. Numbers may have any real type and byte order.
// Pickled objects are refused, and other arrays are ignored. On failure
// *container is unchanged.
[[nodiscard]] bool ReadNpz(const std::string& path, MatrixContainer* container,
                           std::string* error);

// Does the same with the content of the file `path`.
[[nodiscard]] bool ReadNpzContent(const std::string& path,
                                  const std::string& content,
                                  MatrixContainer* container,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_NPZ_H_
