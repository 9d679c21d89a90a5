// Reads the matrices that Nastran and OptiStruct write as bulk data entries
// DMIG into punch files, for example those of a superelement with
// PARAM,EXTOUT,DMIGPCH.

#ifndef PINODE_STRUCTURE_MATRICES_DMIG_H_
#define PINODE_STRUCTURE_MATRICES_DMIG_H_

#include <string>
#include <vector>

#include "pinode/structure/matrices/dof_matrix.h"

namespace pinode {

struct DmigMatrix {
  std::string name;
  DofMatrix matrix;
  // Reason why it cannot be a matrix of a structure ("it is complex"). The
  // matrix is then empty. Empty text: no fault.
  std::string fault;
};

// Reads all DMIG entries of a file, in small, large and free fields, and skips
// all others (GRID, ASET1, ...). DOFs are "node.direction", those of scalar
// points "point.0". Symmetric matrices hold one triangle or both. On failure
// *matrices is unchanged and *error is `file:line: error, expected ...`.
[[nodiscard]] bool ReadDmig(const std::string& path,
                            std::vector<DmigMatrix>* matrices,
                            std::string* error);

// Does the same with the content of the file `path`.
[[nodiscard]] bool ReadDmigText(const std::string& path,
                                const std::string& content,
                                std::vector<DmigMatrix>* matrices,
                                std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_DMIG_H_
