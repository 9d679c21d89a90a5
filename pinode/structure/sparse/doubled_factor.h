// Factors in twice the working precision. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_DOUBLED_FACTOR_H_
#define PINODE_STRUCTURE_SPARSE_DOUBLED_FACTOR_H_

#include <memory>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/sparse_factor.h"

namespace pinode {

// Number of rows above which these factors take too long: with 300 rows all
// modes by them take 0.6 s, with the cube of the number.
inline constexpr Eigen::Index kMostDoubled = 400;

// Returns the factors A + B = L L' of a positive definite matrix, computed with
// 32 digits; nullptr if it is not positive definite. `rest` is B, the rounding
// of the entries of A. Stiff links beside soft springs leave few digits of the
// soft ones in factors of 16 digits: with links of 1e10 times a spring its
// frequency is wrong by 1e-6.
std::unique_ptr<SparseFactor> MakeDoubledFactor(const SparseMatrix& symmetric,
                                                const SparseMatrix& rest);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_DOUBLED_FACTOR_H_
