// Reads a finite-element model exported by any supported program. All models
// enter through this function.

#ifndef PINODE_STRUCTURE_DECKS_FINITE_ELEMENT_FILES_H_
#define PINODE_STRUCTURE_DECKS_FINITE_ELEMENT_FILES_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Location of one matrix.
struct MatrixSource {
  // File of the matrix. Empty: there is none.
  std::string path;
  // Name of the matrix in a file that holds several (.op4, .mat, .npz), in any
  // case. Empty: the only matrix of the file, or one with a usual name: m,
  // mass, mgg, maa, ..., c, damping, ..., k, stiffness, ....
  std::string variable;
  // Number of the matrix among several of that name, from 1. OP4 files of
  // superelements have such matrices. 0: there is only one.
  int occurrence = 0;
  // Matrix given in memory instead of a file. `path` is then its name in
  // messages.
  std::shared_ptr<const SparseMatrix> array = nullptr;
};

struct FiniteElementFiles {
  MatrixSource mass;
  MatrixSource damping;  // may be absent
  MatrixSource stiffness;
  // File with a list of DOF names, one per line, for formats without names.
  // CalculiX's .dof file is one. Empty: names come from the matrices' files.
  // For .sti or .mas they come from the .dof file of the same name if it
  // exists.
  std::string dof_names;
  // DOF names given in memory instead of such a file, if not empty.
  std::vector<std::string> names;
};

// Reads the matrices and checks them (FiniteElementModel::IsValid). The format
// follows from the extension:
//
//   .mtx              Matrix Market (by its first line), else Abaqus
//   .sti .mas         CalculiX
//   .op4              Nastran OUTPUT4
//   .mat              MATLAB 5 or 7.3
//   .npz              NumPy, SciPy
//   .csv              full matrix as text (matrix_io.h)
//
// .mtx, .sti, .mas, .csv and .dof may be compressed with gzip (.sti.gz). Abaqus
// matrices are assembled by DOF name, because each file names only the DOFs for
// which it has entries. All others are assembled by position. Repeated DOF
// names are numbered. model->notes describes special DOFs. On failure *model is
// unchanged and *error is `file:line: error, expected ...`.
[[nodiscard]] bool ReadFiniteElementModel(const FiniteElementFiles& files,
                                          FiniteElementModel* model,
                                          std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_FINITE_ELEMENT_FILES_H_
