// Chooses the mass, damping or stiffness matrix of a file that holds several.

#ifndef PINODE_STRUCTURE_DECKS_MATRIX_CHOICE_H_
#define PINODE_STRUCTURE_DECKS_MATRIX_CHOICE_H_

#include <cstddef>
#include <string>
#include <vector>

namespace pinode {

struct MatrixSource;

// Part that a matrix plays in a model.
enum MatrixRole {
  kMassMatrix,
  kDampingMatrix,
  kStiffnessMatrix,
  kNumMatrixRoles
};

// Returns "mass", "damping" or "stiffness".
const char* RoleName(int role);

// Finds the matrix that `source` asks for among `names`, those of its file. If
// it asks for none, a usual name of the role decides (m, mass, mgg, ...). With
// `may_be_only`, a single matrix is taken whatever its name. On failure *error
// is a message that begins with the path and says which names are there.
bool ChooseMatrix(int role, const MatrixSource& source,
                  const std::vector<std::string>& names, bool may_be_only,
                  size_t* chosen, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_MATRIX_CHOICE_H_
