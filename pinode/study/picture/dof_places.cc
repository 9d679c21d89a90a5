#include "pinode/study/picture/dof_places.h"

#include <algorithm>
#include <cstdlib>

#include "pinode/record/files/universal_file.h"

namespace pinode {

DofPlaces::DofPlaces(const PlacedGeometry& placed)
    : placed_(placed), node_index_(NodeIndex(placed.geometry)) {}

std::vector<DofPlaces::Place> DofPlaces::Of(const std::string& dof) const {
  std::vector<PlacedGeometry::Place> named;
  const auto given = placed_.dofs.find(dof);
  PlacedGeometry::Place own;
  int number = 0;
  if (given != placed_.dofs.end()) {
    named = given->second;
  } else if (SplitDofName(dof, &own.node, &own.direction)) {
    named = {own};
  } else if (ParseUniversalPlace(dof, &number, &own.direction)) {
    own.node = std::to_string(number);
    own.sign = own.direction < 0 ? -1.0 : 1.0;
    own.direction = std::abs(own.direction);
    named = {own};
  }
  std::vector<Place> places;
  for (const PlacedGeometry::Place& place : named) {
    const auto node = node_index_.find(place.node);
    if (node == node_index_.end() || place.direction < 1 ||
        place.direction > 3) {
      continue;
    }
    const Eigen::Vector3d direction =
        placed_.geometry.Direction(node->second, place.direction);
    if (direction.isZero()) continue;
    places.push_back({node->second, place.sign * direction});
  }
  return places;
}

bool DofPlaces::AddArrows(const std::string& name,
                          const std::map<std::string, double>& weights,
                          std::vector<StructurePicture::Arrow>* arrows) const {
  std::map<int, Eigen::Vector3d> at_nodes;
  for (const auto& [dof, weight] : weights) {
    const std::vector<Place> places = Of(dof);
    if (places.empty()) continue;
    const auto own =
        at_nodes.emplace(places[0].node, Eigen::Vector3d::Zero().eval()).first;
    own->second += weight * places[0].direction;
  }
  bool placed = false;
  for (const auto& [node, sum] : at_nodes) {
    if (!(sum.norm() > 0.0)) continue;
    placed = true;
    const StructurePicture::Arrow arrow = {name, node, sum.normalized()};
    const bool known = std::any_of(
        arrows->begin(), arrows->end(),
        [&arrow](const StructurePicture::Arrow& other) {
          return other.name == arrow.name && other.node == arrow.node &&
                 other.direction.isApprox(arrow.direction);
        });
    if (!known) arrows->push_back(arrow);
  }
  return placed;
}

}  // namespace pinode
