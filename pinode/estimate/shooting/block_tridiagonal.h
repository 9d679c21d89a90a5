// Elimination of the segment starts from the normal equations.

#ifndef PINODE_ESTIMATE_SHOOTING_BLOCK_TRIDIAGONAL_H_
#define PINODE_ESTIMATE_SHOOTING_BLOCK_TRIDIAGONAL_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Symmetric positive definite system of K blocks of size m,
//
//   A_0  B_0                     x_0     r_0
//   B_0' A_1  B_1                x_1     r_1
//        B_1' A_2  ..            ..   =  ..
//             ..   ..            ..      ..
//
// with r_k of m x c: the normal equations of the starts of K neighbouring
// shooting segments. Solved by block Cholesky elimination in O(K m^2 (m + c));
// for c = 1 and linear dynamics this is the Rauch-Tung-Striebel smoother
// (AIAA Journal 3 (1965) 1445-1450) in information form.
class BlockTridiagonal {
 public:
  // K, m: at least 1.
  BlockTridiagonal(int num_blocks, int block_size);

  int num_blocks() const { return static_cast<int>(diagonal_.size()); }
  int block_size() const { return block_size_; }

  // Blocks to be filled before Factor; zero after construction.
  Matrix& diagonal(int k) { return diagonal_[static_cast<size_t>(k)]; }
  Matrix& coupling(int k) { return coupling_[static_cast<size_t>(k)]; }
  void SetZero();

  // Adds `damping` times each diagonal entry and factors. False where the
  // system is not positive definite.
  [[nodiscard]] bool Factor(double damping);

  // Solves in place for c right-hand sides, the rows of a c x (K m) matrix:
  // what a block works on lies together.
  void Solve(Matrix* right) const;

  // The first half of Solve, L^-1 r of each r, so that
  // r' A^-1 r = |L^-1 r|^2; and the second half, L^-T r.
  void SolveLower(Matrix* right) const;
  void SolveUpper(Matrix* right) const;

 private:
  int block_size_;
  std::vector<Matrix> diagonal_;
  std::vector<Matrix> coupling_;
  // Cholesky factor: L_k on the diagonal, M_k = B_k' L_k^-T below it.
  std::vector<Matrix> lower_;
  std::vector<Matrix> below_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_BLOCK_TRIDIAGONAL_H_
