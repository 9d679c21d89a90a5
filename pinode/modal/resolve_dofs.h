// Shapes at DOFs from sensors along any directions.

#ifndef PINODE_MODAL_RESOLVE_DOFS_H_
#define PINODE_MODAL_RESOLVE_DOFS_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/modal/merge_setups.h"

namespace pinode {

// What the entry of a shape at a place is: a sum of weights times DOFs.
struct PlaceOfShape {
  std::string place;
  std::string channel;                 // of a sensor there
  std::map<std::string, double> dofs;  // DOF: weight, not zero
};

// A DOF that sensors, of all set-ups together, determine by sums that it has a
// part in takes their place: three oblique sensors at a node become its three
// translations. Its entry is the least squares solution, with the covariance
// that follows. Sums that no DOF's solution makes up for stay beside them, and
// so does what measures a DOF itself. Shapes are scaled so that their largest
// entry is one. `places`: of merged->places, others are passed over; each
// afterwards.
void ResolveDofs(std::vector<PlaceOfShape>* places, MergedModes* merged);

}  // namespace pinode

#endif  // PINODE_MODAL_RESOLVE_DOFS_H_
