// Computes shapes at DOFs from sensors along any directions.

#ifndef PINODE_MODAL_RESOLVE_DOFS_H_
#define PINODE_MODAL_RESOLVE_DOFS_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/modal/merge_setups.h"

namespace pinode {

// Meaning of the entry of a shape at a place: a sum of weights times DOFs.
struct PlaceOfShape {
  std::string place;
  std::string channel;                 // of a sensor there
  std::map<std::string, double> dofs;  // DOF: weight, not zero
};

// Replaces sums by DOFs if the sensors of all set-ups together determine the
// DOF: three oblique sensors at a node become its three translations. The entry
// of a DOF is the least squares solution, with its covariance. Sums that no
// DOF's solution replaces stay in the list, and so do sensors that measure a
// DOF directly. Shapes are scaled so that their largest entry is one. `places`:
// those in merged->places are used; afterwards it lists each of them.
void ResolveDofs(std::vector<PlaceOfShape>* places, MergedModes* merged);

}  // namespace pinode

#endif  // PINODE_MODAL_RESOLVE_DOFS_H_
