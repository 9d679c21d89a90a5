// The matrices that CalculiX writes with *FREQUENCY, SOLVER=MATRIXSTORAGE:
// job.sti (K), job.mas (M) and job.dof (DOFs).

#ifndef PINODE_STRUCTURE_MATRICES_CALCULIX_H_
#define PINODE_STRUCTURE_MATRICES_CALCULIX_H_

#include <string>
#include <vector>

#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {

// Entries `row column value`, one a line, without a header. A file of one
// triangle stands for both; one in which every entry off the diagonal has its
// mirror image is taken as it is; a mixture is refused, for something is
// missing. *size becomes the largest index: what the file shows of the number
// of DOFs. Fails on an empty file, on entries given twice and on indices beyond
// kMaxFiniteElementDofs; *error reads `file:line: what, and what was expected`.
[[nodiscard]] bool ReadIndexedEntries(const std::string& path,
                                      std::vector<MatrixEntry>* entries,
                                      bool* mirrored, int* size,
                                      std::string* error);

// The same from the content of the file `path`.
[[nodiscard]] bool ReadIndexedEntriesText(const std::string& path,
                                          const std::string& content,
                                          std::vector<MatrixEntry>* entries,
                                          bool* mirrored, int* size,
                                          std::string* error);

// One DOF a line, `node.direction` in a .dof file or any name without blanks;
// blank lines are skipped, and lines that begin with #. Names may repeat.
[[nodiscard]] bool ReadDofNames(const std::string& path,
                                std::vector<std::string>* names,
                                std::string* error);

// Whether a set of entries is one triangle (*mirrored) or both; false, with a
// sentence about *at in *what, for a mixture. Reorders the entries.
bool FindTriangle(std::vector<MatrixEntry>* entries, bool* mirrored,
                  MatrixEntry* at, std::string* what);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_CALCULIX_H_
