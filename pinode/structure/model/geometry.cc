#include "pinode/structure/model/geometry.h"

#include <algorithm>
#include <cctype>
#include <unordered_set>

namespace pinode {
namespace {

bool SameInAnyCase(const std::string& a, const std::string& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(),
                    [](unsigned char x, unsigned char y) {
                      return std::tolower(x) == std::tolower(y);
                    });
}

}  // namespace

int NumCorners(ElementShape shape) {
  switch (shape) {
    case ElementShape::kPoint:
      return 1;
    case ElementShape::kLine:
      return 2;
    case ElementShape::kTriangle:
      return 3;
    case ElementShape::kQuadrilateral:
    case ElementShape::kTetrahedron:
      return 4;
    case ElementShape::kPyramid:
      return 5;
    case ElementShape::kWedge:
      return 6;
    case ElementShape::kHexahedron:
      return 8;
  }
  return 0;
}

Eigen::Vector3d StructureGeometry::Direction(int node, int direction) const {
  const auto own = axes.find(node);
  if (own == axes.end()) return Eigen::Vector3d::Unit(direction - 1);
  return own->second.row(direction - 1).transpose();
}

int StructureGeometry::SetIndex(const std::string& name) const {
  for (size_t i = 0; i < sets.size(); ++i) {
    if (SameInAnyCase(sets[i].name, name)) return static_cast<int>(i);
  }
  return -1;
}

bool StructureGeometry::IsValid(std::string* error) const {
  if (positions.rows() != num_nodes() ||
      (num_nodes() > 0 && positions.cols() != 3)) {
    *error = "the geometry has " + std::to_string(num_nodes()) +
             " nodes, expected as many positions of three coordinates";
    return false;
  }
  if (!positions.allFinite()) {
    *error = "a position of the geometry is not finite";
    return false;
  }
  std::unordered_set<std::string> seen;
  for (const std::string& name : node_names) {
    if (name.empty() || !seen.insert(name).second) {
      *error = "node '" + name + "' of the geometry is given twice or has no " +
               "name, expected different names";
      return false;
    }
  }
  for (const Element& element : elements) {
    const bool inside = std::all_of(
        element.nodes.begin(), element.nodes.end(),
        [this](int node) { return node >= 0 && node < num_nodes(); });
    if (!inside ||
        static_cast<int>(element.nodes.size()) != NumCorners(element.shape)) {
      *error = "an element of the geometry has other nodes than it needs";
      return false;
    }
  }
  for (const Set& set : sets) {
    for (const int element : set.elements) {
      if (element >= 0 && element < static_cast<int>(elements.size())) continue;
      *error = "set '" + set.name + "' has an element that does not exist";
      return false;
    }
  }
  return true;
}

std::unordered_map<std::string, int> NodeIndex(
    const StructureGeometry& geometry) {
  std::unordered_map<std::string, int> index;
  for (int i = 0; i < geometry.num_nodes(); ++i) {
    index.emplace(geometry.node_names[static_cast<size_t>(i)], i);
  }
  return index;
}

bool SplitDofName(const std::string& dof, std::string* node, int* direction) {
  const size_t point = dof.rfind('.');
  if (point == std::string::npos || point == 0 || point + 2 != dof.size() ||
      dof[point + 1] < '1' || dof[point + 1] > '6') {
    return false;
  }
  *node = dof.substr(0, point);
  *direction = dof[point + 1] - '0';
  return true;
}

const std::vector<std::vector<int>>& FacesOf(ElementShape shape) {
  using Faces = std::vector<std::vector<int>>;
  static const auto& faces = *new std::vector<Faces>{
      {{0}},
      {{0, 1}},
      {{0, 1, 2}},
      {{0, 1, 2, 3}},
      {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
      {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
      {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}},
      {{0, 3, 2, 1},
       {4, 5, 6, 7},
       {0, 1, 5, 4},
       {1, 2, 6, 5},
       {2, 3, 7, 6},
       {3, 0, 4, 7}}};
  return faces[static_cast<size_t>(shape)];
}

}  // namespace pinode
