// Reads the matrices that CalculiX writes with *FREQUENCY,
// SOLVER=MATRIXSTORAGE: job.sti (K), job.mas (M) and job.dof (DOFs).

#ifndef PINODE_STRUCTURE_MATRICES_CALCULIX_H_
#define PINODE_STRUCTURE_MATRICES_CALCULIX_H_

#include <string>
#include <vector>

#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {

// Reads entries `row column value`, one per line, without a header. A file with
// one triangle stands for both. A file in which every entry off the diagonal
// has its mirror image is taken as it is. A mixture is refused, because entries
// are missing. *size becomes the largest index, a lower bound of the number of
// DOFs. Fails on an empty file, on entries given twice and on indices beyond
// kMaxFiniteElementDofs. *error is `file:line: error, expected ...`.
[[nodiscard]] bool ReadIndexedEntries(const std::string& path,
                                      std::vector<MatrixEntry>* entries,
                                      bool* mirrored, int* size,
                                      std::string* error);

// Does the same with the content of the file `path`.
[[nodiscard]] bool ReadIndexedEntriesText(const std::string& path,
                                          const std::string& content,
                                          std::vector<MatrixEntry>* entries,
                                          bool* mirrored, int* size,
                                          std::string* error);

// Reads one DOF name per line: `node.direction` in a .dof file, or any name
// without blanks. Skips blank lines and lines that begin with #. Names may
// repeat.
[[nodiscard]] bool ReadDofNames(const std::string& path,
                                std::vector<std::string>* names,
                                std::string* error);

// Finds out if a set of entries is one triangle (*mirrored) or both. Returns
// false for a mixture, with a sentence about *at in *what. Reorders the
// entries.
bool FindTriangle(std::vector<MatrixEntry>* entries, bool* mirrored,
                  MatrixEntry* at, std::string* what);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_CALCULIX_H_
