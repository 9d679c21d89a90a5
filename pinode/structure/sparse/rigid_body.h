// Motions of a model that nothing resists, in the coordinates of a reduced one.

#ifndef PINODE_STRUCTURE_SPARSE_RIGID_BODY_H_
#define PINODE_STRUCTURE_SPARSE_RIGID_BODY_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {

// The shapes of the rigid-body modes, n x their number.
Matrix RigidBodyShapes(const SparseModes& modes);

// DOFs that have to be held beside `held` so that no combination of the
// rigid-body modes is left; empty where `held` do. Of those that could be named
// each carries the most kinetic energy of what was left before it.
// `shapes`: n x modes; `mass_diagonal`: n.
std::vector<int> DofsToHold(const Matrix& shapes, const Vector& mass_diagonal,
                            const std::vector<int>& held);

// The nearest matrix to A (c x c, symmetric, in the metric of its diagonal)
// that does not resist the motions R (c x motions): A R = 0 to the rounding of
// A's own entries.
Matrix WithoutResistance(const Matrix& matrix, const Matrix& motions);

// T' A T, exactly symmetric, of a matrix A over all DOFs. Entries of K that
// cancel in T' K T are larger than what is left by powers of the number of
// elements, and their rounding would hold a rigid body a little, or push it.
// Where A resists the motions R (coordinates x motions) by no more than that,
// the result does not resist them at all; a group of supports keeps what it
// has.
Matrix ReduceMatrix(const SparseMatrix& matrix, const Matrix& basis,
                    const Matrix& motions);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_RIGID_BODY_H_
