// Reads sparse matrices in the Harwell-Boeing and Rutherford-Boeing formats,
// which ANSYS writes with HBMAT, and the list of rows that goes with them.

#ifndef PINODE_STRUCTURE_MATRICES_HARWELL_BOEING_H_
#define PINODE_STRUCTURE_MATRICES_HARWELL_BOEING_H_

#include <string>
#include <vector>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Returns true for the extensions .hb, .rb, .rsa, .rua and .matrix, in any
// case.
bool IsHarwellBoeing(const std::string& path);

// Reads an assembled real matrix by columns, symmetric or general (types RSA,
// RUA; also ISA, IUA): I. S. Duff, R. G. Grimes, J. G. Lewis, "Users' guide
// for the Harwell-Boeing sparse matrix collection", TR/PA/92/86, CERFACS, 1992.
// Right-hand sides behind the matrix are not read. Larger matrices than
// `max_dimension` are refused before any allocation. On failure *matrix is
// unchanged and *error is `file:line: error, expected ...`.
[[nodiscard]] bool ReadHarwellBoeing(const std::string& path, int max_dimension,
                                     SparseMatrix* matrix, std::string* error);

// Does the same with the content of the file `path`.
[[nodiscard]] bool ReadHarwellBoeingText(const std::string& path,
                                         const std::string& content,
                                         int max_dimension,
                                         SparseMatrix* matrix,
                                         std::string* error);

// Reads the mapping file that HBMAT writes on request: lines `row node
// direction` behind a title, the direction as UX, UY, UZ, ROTX, ROTY, ROTZ or a
// number. Returns "node.direction" of each row, with directions 1 to 6; other
// labels (TEMP) stay as they are. Each row must be given once.
[[nodiscard]] bool ReadRowMapping(const std::string& path,
                                  std::vector<std::string>* names,
                                  std::string* error);

// Does the same with the content of the file `path`.
[[nodiscard]] bool ReadRowMappingText(const std::string& path,
                                      const std::string& content,
                                      std::vector<std::string>* names,
                                      std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_HARWELL_BOEING_H_
