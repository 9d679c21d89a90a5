// Where the DOFs of a model are in a geometry.

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

  // `placed` outlives it.
  explicit DofPlaces(const PlacedGeometry& placed);

  // As the geometry says; else of "node.direction" and "node:x" as they are
  // called; along the node's own directions, where it has such. None of
  // rotations, and where nobody says.
  std::vector<Place> Of(const std::string& dof) const;

  // Adds an arrow at each node that `weights`, of DOFs, have a part at; where
  // DOFs move several nodes, as of a floor, at the first of them. One that is
  // there is not added again. False where no place is known.
  [[nodiscard]] bool AddArrows(
      const std::string& name, const std::map<std::string, double>& weights,
      std::vector<StructurePicture::Arrow>* arrows) const;

 private:
  const PlacedGeometry& placed_;
  const std::unordered_map<std::string, int> node_index_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_PICTURE_DOF_PLACES_H_
