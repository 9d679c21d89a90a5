// Content of a file that holds several matrices by name (OP4, MATLAB, NumPy).

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_CONTAINER_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_CONTAINER_H_

#include <string>
#include <vector>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

struct NamedMatrix {
  std::string name;
  SparseMatrix matrix;
  // Reason why the variable cannot be a matrix of a structure ("it is
  // complex"). The matrix is then empty. Empty text: no fault. A file may hold
  // such variables beside the wanted ones.
  std::string fault;
};

struct MatrixContainer {
  std::vector<NamedMatrix> matrices;
  // One name per row, as in the file. Empty if the file has none.
  std::vector<std::string> dof_names;
};

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_CONTAINER_H_
