// Lowest modes from factors that are at hand. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_MODES_FROM_FACTORS_H_
#define PINODE_STRUCTURE_SPARSE_MODES_FROM_FACTORS_H_

#include <memory>
#include <string>

#include "pinode/structure/sparse/shifted_factors.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {

// Does what ComputeLowestModes does, with `factors` of the positive definite K
// itself, which would take the most time otherwise.
[[nodiscard]] bool ModesFromFactors(std::unique_ptr<ShiftedFactors> factors,
                                    const SparseMatrix& mass,
                                    const SparseMatrix& stiffness,
                                    int num_modes, SparseModes* modes,
                                    std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_MODES_FROM_FACTORS_H_
