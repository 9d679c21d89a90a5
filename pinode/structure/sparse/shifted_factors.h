// Sparse factors of K - shift M. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_SHIFTED_FACTORS_H_
#define PINODE_STRUCTURE_SPARSE_SHIFTED_FACTORS_H_

#include <memory>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/sparse_factor.h"

namespace pinode {

// Factorisation P S (K - shift M) S P' = L D L'. The diagonal matrix S of
// powers of two brings the diagonal of the matrix near one, so that units,
// rotations and penalties do not matter. There is no pivoting. The signs of D
// give the inertia if the factors are accurate, which SolveError shows.
class ShiftedFactors {
 public:
  // Computes the factors of a positive definite matrix. Returns false if it is
  // not positive definite beyond rounding. Nothing but WeakestDof may be called
  // then. A small matrix of wide range is factorised with 32 digits, which need
  // a shift that is a power of two or zero.
  [[nodiscard]] bool FactoriseDefinite(const SparseMatrix& mass,
                                       const SparseMatrix& stiffness,
                                       double shift);
  // Computes the factors of any matrix. Returns false if a pivot is zero or not
  // finite.
  [[nodiscard]] bool Factorise(const SparseMatrix& mass,
                               const SparseMatrix& stiffness, double shift);

  // Returns the DOF of the smallest pivot, or of the pivot that failed, or -1
  // if that is not known.
  Eigen::Index WeakestDof() const { return factor_->WeakestDof(); }
  Eigen::Index NumNegative() const {
    return (factor_->pivots().array() < 0.0).count();
  }
  // Returns the operations that the factors took, or 0 if they are few.
  double Operations() const { return factor_->Operations(); }

  // Returns true if the factors have 32 digits.
  bool IsDoubled() const { return factor_->IsDoubled(); }

  // Returns the accuracy of a solution with these factors: the relative error
  // of the right side, in the scaled matrix.
  double SolveError(const SparseMatrix& mass, const SparseMatrix& stiffness,
                    double shift) const;

  // The following functions take and return n x m matrices. Many columns at a
  // time take less work than one after the other.

  // Returns (K - shift M)^-1 B.
  Matrix Solve(const Matrix& right) const;
  // Returns F^-T Y with F = S^-1 P' L |D|^1/2. Hence F F' = K - shift M if that
  // is positive definite.
  Matrix ToShape(const Matrix& y) const;
  // Returns F^-1 B.
  Matrix FromForce(const Matrix& force) const;

 private:
  SparseMatrix ScaledMatrix(const SparseMatrix& mass,
                            const SparseMatrix& stiffness, double shift);

  Vector scale_;
  std::unique_ptr<SparseFactor> factor_;
};

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_SHIFTED_FACTORS_H_
