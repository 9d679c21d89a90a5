// Penalised least squares, solved by exchange of active entries.

#ifndef PINODE_DISCOVER_ACTIVE_SET_H_
#define PINODE_DISCOVER_ACTIVE_SET_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

struct ActiveSetSolution {
  Vector z;
  // Entries that are not held at 0, ascending.
  std::vector<int> active;
  // Number of linear systems solved; 1 if the start had the right active set.
  int num_faces = 0;
  // False if rounding prevented the optimality conditions from being met.
  bool converged = false;
};

// Solves
//
//   min_z  1/2 |b - A z|^2 + sum_j penalty_j |z_j|,   signs_j z_j >= 0
//                                                     where signs_j is not 0
//
// (penalty_j >= 0) to rounding, by exchange of active entries. With support and
// signs fixed the problem is a linear system. A step towards its solution ends
// where an entry reaches 0, which then leaves. If none does, an inactive entry
// enters: the one that most violates the optimality conditions
//
//   |A_j'(b - A z)| <= penalty_j
//
// (Osborne, Presnell, Turlach 2000; Lee, Battle, Raina, Ng 2007; without
// penalty and with signs this is Lawson and Hanson's NNLS). Columns that depend
// on others leave the active set on the way.
//
// start: any vector of A's number of columns that keeps the signs; the nearer
// to the solution, the fewer exchanges. With one signed or penalised entry the
// active set begins at the start's non-zero entries; entries with neither begin
// active.
ActiveSetSolution SolveActiveSet(const Matrix& A, const Vector& b,
                                 const Vector& penalty,
                                 const std::vector<int>& signs,
                                 const Vector& start);

}  // namespace pinode

#endif  // PINODE_DISCOVER_ACTIVE_SET_H_
