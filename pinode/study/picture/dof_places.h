// Places of a model's DOFs in a geometry.

#ifndef PINODE_STUDY_PICTURE_DOF_PLACES_H_
#define PINODE_STUDY_PICTURE_DOF_PLACES_H_

#include <Eigen/Core>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "pinode/study/picture/structure_picture.h"

namespace pinode {

class DofPlaces {
 public:
  struct Place {
    int node = 0;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  };

  // Keeps a reference to `placed`, which must outlive the object.
  explicit DofPlaces(const PlacedGeometry& placed);

  // Returns the places of a DOF: as the geometry says; else from names
  // "node.direction" and "node:x", along the node's own directions if it has
  // such. Empty for rotations and unknown places.
  std::vector<Place> Of(const std::string& dof) const;

  // Adds an arrow at each node of the DOFs in `weights`, unless it exists. If
  // DOFs move several nodes, as of a floor, the arrow is at the first. Returns
  // false if no place is known.
  [[nodiscard]] bool AddArrows(
      const std::string& name, const std::map<std::string, double>& weights,
      std::vector<StructurePicture::Arrow>* arrows) const;

 private:
  const PlacedGeometry& placed_;
  const std::unordered_map<std::string, int> node_index_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_PICTURE_DOF_PLACES_H_
