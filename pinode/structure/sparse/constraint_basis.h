// Bases of Guyan, and of Craig and Bampton. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_CONSTRAINT_BASIS_H_
#define PINODE_STRUCTURE_SPARSE_CONSTRAINT_BASIS_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/shifted_factors.h"

namespace pinode {

// Positions of the kept DOFs, and of all others in ascending order.
struct Partition {
  std::vector<int> kept;
  std::vector<int> others;
};

// Computes T of Guyan, n x kept DOFs, followed by `num_modes` columns of modes
// with the kept DOFs held. `factors` are those of the whole, positive definite
// K, which answer both questions. With nullptr, the part of K that belongs to
// the other DOFs is factorised. Returns false if the others can move without
// stiffness, or have fewer modes.
[[nodiscard]] bool ConstraintBasis(const FiniteElementModel& model,
                                   const Partition& partition, int num_modes,
                                   std::unique_ptr<ShiftedFactors> factors,
                                   Matrix* basis, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_CONSTRAINT_BASIS_H_
