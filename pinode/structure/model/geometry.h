// Positions of a structure's nodes, and the elements that join them. Used for
// pictures, and to check if a place exists.

#ifndef PINODE_STRUCTURE_MODEL_GEOMETRY_H_
#define PINODE_STRUCTURE_MODEL_GEOMETRY_H_

#include <Eigen/Core>
#include <string>
#include <unordered_map>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

enum class ElementShape {
  kPoint,          // 1 node
  kLine,           // 2
  kTriangle,       // 3
  kQuadrilateral,  // 4, around
  kTetrahedron,    // 4
  kPyramid,        // 5: the base around, then the tip
  kWedge,          // 6: two triangles, one above the other
  kHexahedron,     // 8: two quadrilaterals, one above the other
};

// Returns the number of corners of a shape.
int NumCorners(ElementShape shape);

struct StructureGeometry {
  struct Element {
    ElementShape shape = ElementShape::kLine;
    std::vector<int> nodes;  // positions of its corners, in VTK's order
  };
  struct Set {
    std::string name;
    std::vector<int> elements;  // ascending, each once
  };

  std::vector<std::string> node_names;  // unique; as in DOFs "node.direction"
  Matrix positions;                     // nodes x 3
  // Directions 1, 2 and 3 of nodes with their own directions, in rows, as
  // vectors in the axes of `positions`. Zero: unknown. All other nodes have the
  // axes of `positions`.
  std::unordered_map<int, Eigen::Matrix3d> axes;
  std::vector<Element> elements;
  std::vector<Set> sets;
  // Parts of the file that were left out, one sentence each.
  std::vector<std::string> notes;

  int num_nodes() const { return static_cast<int>(node_names.size()); }
  bool empty() const { return node_names.empty(); }
  // Returns direction 1, 2 or 3 at a node, a unit vector. Zero if it is
  // unknown.
  Eigen::Vector3d Direction(int node, int direction) const;
  // Returns the position of a set by name (in any case), -1 if there is none.
  int SetIndex(const std::string& name) const;

  // Checks names, sizes, finite positions and indices. On failure *error is one
  // sentence.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Returns the positions of the nodes by name.
std::unordered_map<std::string, int> NodeIndex(
    const StructureGeometry& geometry);

// Splits a DOF "node.direction" into node and direction (1 to 3 translations, 4
// to 6 rotations). Returns false for other names, such as "12.3#1" of a node
// that a program has added.
[[nodiscard]] bool SplitDofName(const std::string& dof, std::string* node,
                                int* direction);

// Returns the faces of an element. Each face lists its corners in order around
// it, as positions among the element's nodes. A line or a point is its own only
// face.
const std::vector<std::vector<int>>& FacesOf(ElementShape shape);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_GEOMETRY_H_
