// Factors of a large sparse symmetric matrix. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_SPARSE_FACTOR_H_
#define PINODE_STRUCTURE_SPARSE_SPARSE_FACTOR_H_

#include <memory>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Factorisation P A P' = L D L' of a symmetric matrix A, n x n, without
// pivoting for size.
class SparseFactor {
 public:
  virtual ~SparseFactor() = default;

  // Computes the factors. Returns false if there are none; then only WeakestDof
  // may be called. Throws std::bad_alloc if the memory does not suffice.
  // The matrix is freed as soon as it is not needed any more.
  [[nodiscard]] virtual bool Factorise(SparseMatrix symmetric) = 0;

  // Returns the diagonal of D.
  const Vector& pivots() const { return pivots_; }
  // Returns the row of A of the smallest pivot, or of the pivot that failed, or
  // -1 if that is not known.
  virtual Eigen::Index WeakestDof() const = 0;
  // Returns the operations of the factorisation, or 0 if nobody has counted.
  virtual double Operations() const { return 0.0; }

  // Returns true if the factors have 32 digits.
  virtual bool IsDoubled() const { return false; }

  // The following functions take and return n x m matrices.

  // Returns A^-1 B.
  virtual Matrix Solve(const Matrix& right) const = 0;
  // Returns |D|^-1/2 L^-1 P B.
  virtual Matrix SolveLower(const Matrix& right) const = 0;
  // Returns P' L^-T |D|^-1/2 B.
  virtual Matrix SolveUpper(const Matrix& right) const = 0;

 protected:
  SparseFactor() = default;
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;

  Vector pivots_;
};

// Returns factors for matrices of any inertia: the signs of D show it. They are
// computed column by column, which is slow for solids of many DOFs.
std::unique_ptr<SparseFactor> MakeSimplicialFactor();

// Returns factors for positive definite matrices with n rows: supernodal ones
// of CHOLMOD for large matrices, if pinode is built with it, otherwise
// simplicial ones. Supernodal factors end at the first negative pivot.
std::unique_ptr<SparseFactor> MakeDefiniteFactor(Eigen::Index n);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_SPARSE_FACTOR_H_
