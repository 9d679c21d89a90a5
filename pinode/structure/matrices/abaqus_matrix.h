// The matrices that Abaqus writes as text with *MATRIX GENERATE and *MATRIX
// OUTPUT (FORMAT=MATRIX INPUT, the default): job_STIF2.mtx, job_MASS2.mtx,
// job_DMPV2.mtx.

#ifndef PINODE_STRUCTURE_MATRICES_ABAQUS_MATRIX_H_
#define PINODE_STRUCTURE_MATRICES_ABAQUS_MATRIX_H_

#include <string>
#include <vector>

#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {

// A DOF as Abaqus names it; nodes below 1 are internal ones of elements.
struct NodeDirection {
  int node = 0;
  int direction = 0;

  bool operator<(const NodeDirection& other) const {
    return node != other.node ? node < other.node : direction < other.direction;
  }
  bool operator==(const NodeDirection& other) const {
    return node == other.node && direction == other.direction;
  }
  // "node.direction".
  std::string Name() const;
};

// An entry points into `dofs`, which are sorted and hold all that the file
// names. Each matrix of a model names its own (M often lacks the rotations), so
// they are put together by name.
struct AbaqusMatrix {
  std::vector<NodeDirection> dofs;
  std::vector<MatrixEntry> entries;
  // Entries off the diagonal stand for two.
  bool mirrored = false;
};

// Lines `node, direction, node, direction, value`; comments begin with **, and
// keyword lines (*MATRIX, ...) are skipped. As for CalculiX, one triangle or
// both. On failure *matrix is untouched and *error reads `file:line: what, and
// what was expected`.
[[nodiscard]] bool ReadAbaqusMatrix(const std::string& path,
                                    AbaqusMatrix* matrix, std::string* error);

// The same from the content of the file `path`.
[[nodiscard]] bool ReadAbaqusMatrixText(const std::string& path,
                                        const std::string& content,
                                        AbaqusMatrix* matrix,
                                        std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_ABAQUS_MATRIX_H_
