// Result files of pinode_modes: modes.json, modes.csv, modes.toml, modes.uff.

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
  // True: harmonics are written to modes.toml too.
  bool keep_harmonics = false;
  // Geometry of the structure, and the modes' shapes at its nodes (see
  // MotionsOfNodes); empty: unknown.
  StructureGeometry geometry;
  std::vector<Eigen::MatrixXcd> motions;
};

// Returns pinode-modes-1, see pinode/case/README.md.
std::string ModesAsJson(const ModesResult& result);

// Returns [[mode]] entries for a case, without harmonics: frequencies with
// sigmas, shapes (rotated to be as real as possible) with the covariance of
// their entries and of these with the frequency. The covariance comes from few
// windows and has many entries. Correlations are shrunk by their share, so that
// it is positive definite.
std::string ModesAsToml(const ModesResult& result);

// Returns data set 55, complex modes in displacements. If shapes at the nodes
// of a geometry are known, they are given there, with nodes and lines (data
// sets 15 and 82). Nodes whose names are numbers keep them, else they are 1, 2,
// ... Otherwise, if all places are called "<node>:<direction>", they keep both;
// else they are nodes 1, 2, ... in their order, with x as direction.
std::string ModesAsUniversalFile(const ModesResult& result);

// Writes all four files to `folder`.
[[nodiscard]] bool WriteModesFiles(const ModesResult& result,
                                   const std::string& folder,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_MODES_FILES_H_
