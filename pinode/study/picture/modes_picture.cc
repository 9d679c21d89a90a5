#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/modal/resolve_dofs.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/study/picture/dof_places.h"
#include "pinode/study/picture/structure_picture.h"

namespace pinode {
namespace {

// Motion of a node along `direction`, from one entry of a shape.
struct EntryAtNode {
  Eigen::Index entry = 0;
  Eigen::Vector3d direction;
};

// Returns the entries by node; sums over DOFs of several nodes have none.
std::map<int, std::vector<EntryAtNode>> EntriesByNode(
    const DofPlaces& dof_places, const std::vector<PlaceOfShape>& places) {
  std::map<int, std::vector<EntryAtNode>> by_node;
  for (size_t p = 0; p < places.size(); ++p) {
    // Number of these DOFs at each node that moves with them.
    std::map<int, std::pair<Eigen::Vector3d, size_t>> at_nodes;
    for (const auto& [dof, weight] : places[p].dofs) {
      std::set<int> once;
      for (const DofPlaces::Place& place : dof_places.Of(dof)) {
        auto& [direction, count] =
            at_nodes
                .emplace(place.node,
                         std::make_pair(Eigen::Vector3d::Zero().eval(), 0u))
                .first->second;
        direction += weight * place.direction;
        if (once.insert(place.node).second) ++count;
      }
    }
    for (const auto& [node, motion] : at_nodes) {
      if (motion.second != places[p].dofs.size()) continue;
      by_node[node].push_back({static_cast<Eigen::Index>(p), motion.first});
    }
  }
  return by_node;
}

// Returns the smallest motion with these components.
Eigen::Vector3d MotionOf(const std::vector<EntryAtNode>& entries,
                         const Vector& values) {
  Matrix directions(static_cast<Eigen::Index>(entries.size()), 3);
  Vector along(directions.rows());
  Eigen::Index count = 0;
  for (const EntryAtNode& entry : entries) {
    if (!std::isfinite(values[entry.entry])) continue;
    directions.row(count) = entry.direction.transpose();
    along[count++] = values[entry.entry];
  }
  if (count == 0) return Eigen::Vector3d::Zero();
  return Eigen::CompleteOrthogonalDecomposition<Matrix>(
             directions.topRows(count))
      .solve(along.head(count));
}

using ByNode = std::map<int, std::vector<EntryAtNode>>;

Eigen::MatrixXcd MotionsOf(const ByNode& by_node, int num_nodes,
                           const Eigen::VectorXcd& shape) {
  const Eigen::VectorXcd values = TurnToReal(shape) * shape;
  Eigen::MatrixXcd motions = Eigen::MatrixXcd::Zero(num_nodes, 3);
  for (const auto& [node, entries] : by_node) {
    motions.row(node).real() = MotionOf(entries, values.real()).transpose();
    motions.row(node).imag() = MotionOf(entries, values.imag()).transpose();
  }
  return motions;
}

}  // namespace

std::vector<Eigen::MatrixXcd> MotionsOfNodes(
    const PlacedGeometry& placed, const std::vector<PlaceOfShape>& places,
    const MergedModes& merged) {
  const ByNode by_node = EntriesByNode(DofPlaces(placed), places);
  std::set<Eigen::Index> placed_entries;
  for (const auto& node : by_node) {
    for (const EntryAtNode& entry : node.second) {
      placed_entries.insert(entry.entry);
    }
  }
  std::vector<Eigen::MatrixXcd> motions;
  if (placed_entries.size() < places.size()) return motions;
  for (const MergedMode& found : merged.modes) {
    motions.push_back(
        MotionsOf(by_node, placed.geometry.num_nodes(), found.mode.shape));
  }
  return motions;
}

StructurePicture MakeModesPicture(const PlacedGeometry& placed,
                                  const std::vector<PlaceOfShape>& sensors,
                                  const std::vector<PlaceOfShape>& places,
                                  const MergedModes& merged) {
  StructurePicture picture;
  picture.geometry = placed.geometry;
  picture.notes = placed.geometry.notes;
  const DofPlaces dof_places(placed);
  std::vector<std::string> unplaced;
  for (const PlaceOfShape& sensor : sensors) {
    if (!dof_places.AddArrows(sensor.channel, sensor.dofs, &picture.sensors)) {
      unplaced.push_back(sensor.channel);
    }
  }
  if (!unplaced.empty()) {
    picture.notes.push_back("No place is known of " + Join(unplaced, ", ") +
                            ".");
  }
  const ByNode by_node = EntriesByNode(dof_places, places);
  const auto moving = static_cast<int>(by_node.size());
  if (moving < placed.geometry.num_nodes()) {
    picture.notes.push_back("Sensors tell of the motion of " +
                            std::to_string(moving) + " of " +
                            std::to_string(placed.geometry.num_nodes()) +
                            " nodes; the others are drawn at rest.");
  }
  for (const MergedMode& found : merged.modes) {
    StructurePicture::Mode mode;
    mode.frequency_hz = found.mode.frequency_hz;
    mode.shape =
        MotionsOf(by_node, placed.geometry.num_nodes(), found.mode.shape)
            .real();
    const double largest = mode.shape.cwiseAbs().maxCoeff();
    if (!(largest > 0.0)) continue;
    mode.shape /= largest;
    picture.modes.push_back(std::move(mode));
  }
  return picture;
}

}  // namespace pinode
