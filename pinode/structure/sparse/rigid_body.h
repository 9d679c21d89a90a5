// Rigid-body motions of a model, in the coordinates of a reduced one.

#ifndef PINODE_STRUCTURE_SPARSE_RIGID_BODY_H_
#define PINODE_STRUCTURE_SPARSE_RIGID_BODY_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {

// Returns the shapes of the rigid-body modes, n x number of rigid-body modes.
Matrix RigidBodyShapes(const SparseModes& modes);

// Returns the DOFs that have to be fixed in addition to `held`, so that no
// combination of the rigid-body modes remains. Empty if `held` are enough. Each
// returned DOF carries the most kinetic energy of the motions that remained
// before it. `shapes`: n x modes; `mass_diagonal`: n.
std::vector<int> DofsToHold(const Matrix& shapes, const Vector& mass_diagonal,
                            const std::vector<int>& held);

// Returns the nearest matrix to A (c x c, symmetric, in the metric of its
// diagonal) that does not resist the motions R (c x motions): A R = 0 to the
// rounding of A's own entries.
Matrix WithoutResistance(const Matrix& matrix, const Matrix& motions);

// Returns T' A T, exactly symmetric, of a matrix A over all DOFs. Entries of K
// that cancel in T' K T exceed the result by powers of the number of elements.
// Their rounding would resist a rigid-body motion a little, or drive it. If A
// resists the motions R (coordinates x motions) by no more than rounding, the
// result does not resist them at all. A group of supports keeps its resistance.
Matrix ReduceMatrix(const SparseMatrix& matrix, const Matrix& basis,
                    const Matrix& motions);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_RIGID_BODY_H_
