// Supernodal Cholesky factors, by CHOLMOD. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_SUPERNODAL_FACTOR_H_
#define PINODE_STRUCTURE_SPARSE_SUPERNODAL_FACTOR_H_

#include <memory>

#include "pinode/structure/sparse/sparse_factor.h"

namespace pinode {

// Returns factors P A P' = L L' whose columns of equal pattern are dense
// blocks, so that BLAS does the work (Y. Chen, T. A. Davis, W. W. Hager,
// S. Rajamanickam, Algorithm 887: CHOLMOD, ACM Trans. Math. Softw. 35(3),
// 2008). They use 64-bit indices. Part of the library only with
// PINODE_SUPERNODAL, because this part of CHOLMOD has the GPL.
std::unique_ptr<SparseFactor> MakeSupernodalFactor();

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_SUPERNODAL_FACTOR_H_
