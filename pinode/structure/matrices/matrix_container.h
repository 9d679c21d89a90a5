// What a file that holds several matrices by name gives (OP4, MATLAB, NumPy).

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_CONTAINER_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_CONTAINER_H_

#include <string>
#include <vector>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

struct NamedMatrix {
  std::string name;
  SparseMatrix matrix;
  // Why it cannot be a matrix of a structure ("it is complex"), else empty; the
  // matrix is empty then. A file may hold such things beside what is wanted.
  std::string fault;
};

struct MatrixContainer {
  std::vector<NamedMatrix> matrices;
  // One for each row, as the file has them; empty if it has none.
  std::vector<std::string> dof_names;
};

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_CONTAINER_H_
