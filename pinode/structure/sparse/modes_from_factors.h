// Lowest modes from factors that are at hand. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_MODES_FROM_FACTORS_H_
#define PINODE_STRUCTURE_SPARSE_MODES_FROM_FACTORS_H_

#include <memory>
#include <string>

#include "pinode/structure/sparse/shifted_factors.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {

// Number of DOFs below which the dense solver is faster.
inline constexpr int kAlwaysDense = 300;

// Does what ComputeLowestModes does with the DOFs `held` standing still: their
// rows of the shapes are zero. *factors are those of the positive definite K
// itself, or nullptr, but not with held DOFs. After success they are the
// factors of K if that is positive definite, otherwise nullptr: the factors
// take most of the time, and several questions can be asked of them.
[[nodiscard]] bool ModesFromFactors(const SparseMatrix& mass,
                                    const SparseMatrix& stiffness,
                                    const std::vector<int>& held, int num_modes,
                                    std::unique_ptr<ShiftedFactors>* factors,
                                    SparseModes* modes, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_MODES_FROM_FACTORS_H_
