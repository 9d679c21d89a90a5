// Eigenvalue of a mode shape in twice the working precision. Not meant for
// other layers.

#ifndef PINODE_STRUCTURE_SPARSE_MODE_QUOTIENT_H_
#define PINODE_STRUCTURE_SPARSE_MODE_QUOTIENT_H_

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Rayleigh's quotient of a shape, and what it leaves.
struct ModeQuotient {
  double eigenvalue = 0.0;  // phi' K phi / phi' M phi
  double modal_mass = 0.0;  // phi' M phi
  Vector residual;          // K phi - eigenvalue M phi
};

// Computes the quotient with 32 digits and rounds it. In stiff links terms
// cancel that are 1e12 times the result, so that 16 digits do not suffice.
ModeQuotient QuotientOf(const SparseMatrix& mass, const SparseMatrix& stiffness,
                        const Vector& shape);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_MODE_QUOTIENT_H_
