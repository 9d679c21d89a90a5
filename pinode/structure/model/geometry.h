// Where a structure's nodes are and what joins them: for pictures, and for what
// asks whether a place exists.

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

// Corners of a shape.
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
  // Directions 1, 2 and 3 of nodes that have their own, in rows, as vectors of
  // the axes of `positions`; zero where nobody says. Others have these axes.
  std::unordered_map<int, Eigen::Matrix3d> axes;
  std::vector<Element> elements;
  std::vector<Set> sets;
  // What was left out, one sentence each.
  std::vector<std::string> notes;

  int num_nodes() const { return static_cast<int>(node_names.size()); }
  bool empty() const { return node_names.empty(); }
  // Direction 1, 2 or 3 at a node, a unit vector; zero where nobody says.
  Eigen::Vector3d Direction(int node, int direction) const;
  // Position of a name (in any case), -1 if there is none.
  int SetIndex(const std::string& name) const;

  // Checks names, sizes, finite positions and indices; one sentence in *error.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Positions of nodes by name.
std::unordered_map<std::string, int> NodeIndex(
    const StructureGeometry& geometry);

// Node and direction (1 to 3 translations, 4 to 6 rotations) of a DOF
// "node.direction"; false for other names, such as "12.3#1" of a node that a
// program has added.
[[nodiscard]] bool SplitDofName(const std::string& dof, std::string* node,
                                int* direction);

// Faces of an element, each as corners around it, positions among the
// element's nodes; those of a line or a point are itself.
const std::vector<std::vector<int>>& FacesOf(ElementShape shape);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_GEOMETRY_H_
