// Reads the matrices that Abaqus writes as text with *MATRIX GENERATE and
// *MATRIX OUTPUT (FORMAT=MATRIX INPUT, the default): job_STIF2.mtx,
// job_MASS2.mtx, job_DMPV2.mtx.

#ifndef PINODE_STRUCTURE_MATRICES_ABAQUS_MATRIX_H_
#define PINODE_STRUCTURE_MATRICES_ABAQUS_MATRIX_H_

#include <string>
#include <vector>

#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {

// A DOF as Abaqus names it. Nodes below 1 are internal nodes of elements.
struct NodeDirection {
  int node = 0;
  int direction = 0;

  bool operator<(const NodeDirection& other) const {
    return node != other.node ? node < other.node : direction < other.direction;
  }
  bool operator==(const NodeDirection& other) const {
    return node == other.node && direction == other.direction;
  }
  // Returns "node.direction".
  std::string Name() const;
};

// A matrix as in the file. Each entry refers to `dofs`, the sorted list of all
// DOFs that the file names. Each matrix of a model names its own DOFs (M often
// lacks the rotations), so matrices are assembled by name.
struct AbaqusMatrix {
  std::vector<NodeDirection> dofs;
  std::vector<MatrixEntry> entries;
  // True if each entry off the diagonal also stands for its mirror image.
  bool mirrored = false;
};

// Reads lines `node, direction, node, direction, value`. Skips comments, which
// begin with **, and keyword lines (*MATRIX, ...). As for CalculiX, the file
// holds one triangle or both. On failure *matrix is unchanged and *error is
// `file:line: error, expected ...`.
[[nodiscard]] bool ReadAbaqusMatrix(const std::string& path,
                                    AbaqusMatrix* matrix, std::string* error);

// Does the same with the content of the file `path`.
[[nodiscard]] bool ReadAbaqusMatrixText(const std::string& path,
                                        const std::string& content,
                                        AbaqusMatrix* matrix,
                                        std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_ABAQUS_MATRIX_H_
