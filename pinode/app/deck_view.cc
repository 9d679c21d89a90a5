#include "pinode/app/deck_view.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "pinode/structure/decks/deck_geometry.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

// Returns the edges of all faces, each once.
std::set<std::pair<int, int>> EdgesOf(const StructureGeometry& geometry) {
  std::set<std::pair<int, int>> edges;
  for (const StructureGeometry::Element& element : geometry.elements) {
    for (const std::vector<int>& face : FacesOf(element.shape)) {
      for (size_t i = 0; i < face.size(); ++i) {
        const int a = element.nodes[static_cast<size_t>(face[i])];
        const int b =
            element.nodes[static_cast<size_t>(face[(i + 1) % face.size()])];
        if (a != b) edges.insert(std::minmax(a, b));
      }
    }
  }
  return edges;
}

}  // namespace

Json DeckView(const StructureGeometry& geometry) {
  const Matrix& at = geometry.positions;
  Json positions = Json::array();
  if (at.rows() > 0) {
    const Eigen::RowVector3d lowest = at.colwise().minCoeff();
    const Eigen::RowVector3d highest = at.colwise().maxCoeff();
    const Eigen::RowVector3d middle = 0.5 * (lowest + highest);
    const double extent = (highest - lowest).maxCoeff();
    const double scale = extent > 0.0 ? 2.0 / extent : 1.0;
    for (Eigen::Index i = 0; i < at.rows(); ++i) {
      for (Eigen::Index k = 0; k < 3; ++k) {
        positions.push_back(scale * (at(i, k) - middle[k]));
      }
    }
  }
  Json edges = Json::array();
  for (const auto& [a, b] : EdgesOf(geometry)) {
    edges.push_back(a);
    edges.push_back(b);
  }
  return {{"names", geometry.node_names},
          {"positions", std::move(positions)},
          {"edges", std::move(edges)}};
}

bool ReadDeckView(const std::string& path, Json* json, std::string* error) {
  StructureGeometry geometry;
  if (!ReadDeckGeometry(path, &geometry, error)) return false;
  if (geometry.num_nodes() > kMostDrawnNodes) {
    *error = "The deck has " + std::to_string(geometry.num_nodes()) +
             " nodes, more than the " + std::to_string(kMostDrawnNodes) +
             " that are drawn. Type the nodes of the sensors";
    return false;
  }
  *json = DeckView(geometry);
  return true;
}

}  // namespace pinode
