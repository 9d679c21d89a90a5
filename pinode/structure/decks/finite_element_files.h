// Reader of finite-element models that any supported program has exported.

#ifndef PINODE_STRUCTURE_DECKS_FINITE_ELEMENT_FILES_H_
#define PINODE_STRUCTURE_DECKS_FINITE_ELEMENT_FILES_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Place of one matrix, in a file or in memory.
struct MatrixSource {
  // Path of the file. Empty: the matrix is absent.
  std::string path;
  // Name of the matrix in a file that holds several (.op4, .pch, .mat, .npz),
  // in any case. Empty: the only matrix of the file, or one with a usual name:
  // m, mass, mgg, maa, ..., c, damping, ..., k, stiffness, ....
  std::string variable;
  // Number of the matrix among several of this name, from 1. OP4 files of
  // superelements have several. 0: there is only one.
  int occurrence = 0;
  // Matrix given in memory instead of a file. `path` is then its name in
  // messages.
  std::shared_ptr<const SparseMatrix> array = nullptr;
};

// Files of a finite-element model.
struct FiniteElementFiles {
  MatrixSource mass;
  MatrixSource damping;  // may be empty
  MatrixSource stiffness;
  // File with one DOF name per line, for formats without names, such as the
  // .dof file of CalculiX, or the .mapping file of ANSYS. Empty: names come
  // from the matrices' files. For .sti and .mas they come from the .dof file of
  // the same name if it exists, for .matrix from the .mapping file.
  std::string dof_names;
  // DOF names in memory, in place of the file. Empty: none are given.
  std::vector<std::string> names;
  // True if a matrix is that of an element set alone. DOFs of other elements
  // may then have neither mass nor stiffness.
  bool has_set = false;
};

// Reads the matrices and checks them (FiniteElementModel::IsValid). The format
// follows from the extension:
//
//   .mtx              Matrix Market (by its first line), else Abaqus
//   .sti .mas         CalculiX
//   .op4              Nastran OUTPUT4
//   .pch .dmig        Nastran DMIG
//   .matrix .hb .rb .rsa .rua  Harwell-Boeing (ANSYS)
//   .mat              MATLAB 5 or 7.3
//   .npz              NumPy, SciPy
//   .csv              full matrix as text (matrix_io.h)
//
// Text files may be compressed with gzip (.sti.gz). Matrices of Abaqus and DMIG
// are assembled by DOF name, because each names only the DOFs for which it has
// entries. All others are assembled by position. Repeated DOF
// names are numbered. model->notes describes special DOFs. On failure returns
// false, *model is unchanged, and *error is `file:line: error, expected ...`.
[[nodiscard]] bool ReadFiniteElementModel(const FiniteElementFiles& files,
                                          FiniteElementModel* model,
                                          std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_FINITE_ELEMENT_FILES_H_
