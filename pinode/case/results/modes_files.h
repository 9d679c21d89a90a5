// What pinode_modes leaves behind: modes.json, modes.csv, modes.toml,
// modes.uff.

#ifndef PINODE_CASE_RESULTS_MODES_FILES_H_
#define PINODE_CASE_RESULTS_MODES_FILES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pinode/modal/merge_setups.h"
#include "pinode/structure/model/geometry.h"

namespace pinode {

struct ModesResult {
  std::vector<std::string> setups;  // names of the records
  MergedModes merged;
  std::vector<std::string> remarks;
  // Where the structure is, and the modes' shapes there (see MotionsOfNodes);
  // empty: not known.
  StructureGeometry geometry;
  std::vector<Eigen::MatrixXcd> motions;
};

// pinode-modes-1, see pinode/case/README.md.
std::string ModesAsJson(const ModesResult& result);

// [[mode]] entries for a case: frequencies with sigmas, shapes (turned so that
// they are as real as they can be) with the covariance of their entries and of
// these with the frequency. The windows that it comes from are few, entries
// many: correlations are shrunk by their share, so that it is positive
// definite.
std::string ModesAsToml(const ModesResult& result);

// Data set 55, complex modes in displacements. Where shapes at the nodes of a
// geometry are known, at these, with nodes and lines (data sets 15 and 82);
// nodes whose names are numbers keep them, else they are 1, 2, ... Without:
// places that are all called "<node>:<direction>" keep both; else they are
// nodes 1, 2, ... in their order, with x as direction.
std::string ModesAsUniversalFile(const ModesResult& result);

// All four into `folder`.
[[nodiscard]] bool WriteModesFiles(const ModesResult& result,
                                   const std::string& folder,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_MODES_FILES_H_
