// The one door through which a finite-element model comes in, whatever program
// exported it.

#ifndef PINODE_STRUCTURE_DECKS_FINITE_ELEMENT_FILES_H_
#define PINODE_STRUCTURE_DECKS_FINITE_ELEMENT_FILES_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Where one matrix is.
struct MatrixSource {
  // Empty: there is none.
  std::string path;
  // Its name in a file that holds several (.op4, .mat, .npz), in any case.
  // Empty: the only matrix of the file, or one with a usual name: m, mass,
  // mgg, maa, ..., c, damping, ..., k, stiffness, ....
  std::string variable;
  // Which of several matrices of that name, from 1, as OP4 files of
  // superelements have them; 0: there is only one.
  int occurrence = 0;
  // In place of a file: `path` is then what messages call it.
  std::shared_ptr<const SparseMatrix> array = nullptr;
};

struct FiniteElementFiles {
  MatrixSource mass;
  MatrixSource damping;  // may be absent
  MatrixSource stiffness;
  // A list of DOF names, one a line, for formats without names; a .dof file of
  // CalculiX is one. Empty: what the matrices' files say; beside .sti or .mas,
  // the .dof file of the same name if there is one.
  std::string dof_names;
  // In place of such a list, where it is not empty.
  std::vector<std::string> names;
};

// Reads the matrices and checks them (FiniteElementModel::IsValid). The format
// follows the extension:
//
//   .mtx              Matrix Market (by its first line), else Abaqus
//   .sti .mas         CalculiX
//   .op4              Nastran OUTPUT4
//   .mat              MATLAB 5 or 7.3
//   .npz              NumPy, SciPy
//   .csv              full matrix as text (matrix_io.h)
//
// .mtx, .sti, .mas, .csv and .dof may be compressed with gzip (.sti.gz).
// Abaqus matrices are put together by DOF name, for each file names only the
// DOFs that it has entries for; all others by position. Repeated DOF names are
// numbered, special DOFs described in model->notes. On failure *model is
// untouched and *error reads `file:line: what, and what was expected`.
[[nodiscard]] bool ReadFiniteElementModel(const FiniteElementFiles& files,
                                          FiniteElementModel* model,
                                          std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_FINITE_ELEMENT_FILES_H_
