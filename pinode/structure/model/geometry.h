// Geometry of a structure: positions of nodes, and elements between them. It
// serves pictures, and the check that a place exists.

#ifndef PINODE_STRUCTURE_MODEL_GEOMETRY_H_
#define PINODE_STRUCTURE_MODEL_GEOMETRY_H_

#include <Eigen/Core>
#include <string>
#include <unordered_map>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Shape of an element, with the number and order of its corners.
enum class ElementShape {
  kPoint,          // 1 corner
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

// Nodes, elements and sets of a structure.
struct StructureGeometry {
  struct Element {
    ElementShape shape = ElementShape::kLine;
    std::vector<int> nodes;  // indices of its corners, in VTK's order
  };
  struct Set {
    std::string name;
    std::vector<int> elements;  // indices, ascending
  };

  std::vector<std::string> node_names;  // unique
  Matrix positions;                     // nodes x 3, any length unit
  // Local axes of nodes, by the node's index. The rows are directions 1, 2 and
  // 3 as unit vectors in the axes of `positions`. Zero: unknown. Nodes without
  // an entry have the axes of `positions`.
  std::unordered_map<int, Eigen::Matrix3d> axes;
  std::vector<Element> elements;
  std::vector<Set> sets;
  // Parts of the file that were ignored, one sentence each.
  std::vector<std::string> notes;

  int num_nodes() const { return static_cast<int>(node_names.size()); }
  bool empty() const { return node_names.empty(); }
  // Returns direction 1, 2 or 3 at a node as a unit vector. Zero if it is
  // unknown.
  Eigen::Vector3d Direction(int node, int direction) const;
  // Returns the index of the set with this name, in upper or lower case. -1:
  // there is none.
  int SetIndex(const std::string& name) const;

  // Checks names, sizes, finite positions and indices. On failure returns
  // false, with one sentence in *error.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Returns the indices of the nodes by their names.
std::unordered_map<std::string, int> NodeIndex(
    const StructureGeometry& geometry);

// Splits the name of a DOF, "node.direction", into the node's name and the
// direction: 1 to 3 for translations, 4 to 6 for rotations. Returns false for
// other names, such as "12.3#1" of a node that a program has added.
[[nodiscard]] bool SplitDofName(const std::string& dof, std::string* node,
                                int* direction);

// Returns the faces of an element. Each face lists its corners in order around
// it, as indices into Element::nodes. A line or a point has one face, itself.
const std::vector<std::vector<int>>& FacesOf(ElementShape shape);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_GEOMETRY_H_
