// Norms of vectors in any unit.

#ifndef PINODE_BASE_STABLE_NORM_H_
#define PINODE_BASE_STABLE_NORM_H_

#include "pinode/base/power_of_two.h"
#include "pinode/base/types.h"

namespace pinode {

// StableNorm returns the Euclidean norm without overflow or underflow on the
// way. Eigen's stableNorm() is not used: it copies into an array on the stack
// and takes it to be aligned like the heap. With the alignment that pinode is
// compiled for (PINODE_ALIGNMENT) it is not, and code by clang crashed there.
inline double StableNorm(const Vector& vector) {
  if (vector.size() == 0) return 0.0;
  const double scale = PowerOfTwoBelow(vector.cwiseAbs().maxCoeff());
  return scale * (vector / scale).norm();
}

// StableUnit returns the vector over its norm, and a vector of zeros as it is.
inline Vector StableUnit(const Vector& vector) {
  const double norm = StableNorm(vector);
  if (norm == 0.0) return vector;
  return vector / norm;
}

}  // namespace pinode

#endif  // PINODE_BASE_STABLE_NORM_H_
