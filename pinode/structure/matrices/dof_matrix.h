// Matrices whose entries name their DOFs, as Abaqus and Nastran (DMIG) write
// them. Each matrix of a model names its own DOFs (M often lacks the
// rotations), so they are put together by name.

#ifndef PINODE_STRUCTURE_MATRICES_DOF_MATRIX_H_
#define PINODE_STRUCTURE_MATRICES_DOF_MATRIX_H_

#include <string>
#include <vector>

#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {

// A DOF by node and direction. In Abaqus, nodes below 1 are internal nodes of
// elements. In Nastran, direction 0 is that of a scalar point.
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

// One entry as in a file, with its line.
struct DofEntry {
  NodeDirection row;
  NodeDirection column;
  double value = 0.0;
  int line = 0;
};

// A matrix as in its file. Each entry refers to `dofs`, the sorted list of all
// DOFs that the file names.
struct DofMatrix {
  std::vector<NodeDirection> dofs;
  std::vector<MatrixEntry> entries;
  // True if each entry off the diagonal also stands for its mirror image.
  bool mirrored = false;

  // Lets the entries refer to `all` instead: a sorted list that contains
  // `dofs`.
  void Renumber(const std::vector<NodeDirection>& all);
};

// Makes a matrix of at least one entry. The entries are one triangle or both
// (FindTriangle). Returns false for a mixture and for more than
// kMaxFiniteElementDofs DOFs, with the line and a sentence about it.
bool MakeDofMatrix(const std::vector<DofEntry>& given, DofMatrix* matrix,
                   int* line, std::string* what);

// Returns the sorted list of all DOFs that the matrices name.
std::vector<NodeDirection> AllDofs(
    const std::vector<const DofMatrix*>& matrices);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_DOF_MATRIX_H_
