// Sparse factors of K - shift M. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_SHIFTED_FACTORS_H_
#define PINODE_STRUCTURE_SPARSE_SHIFTED_FACTORS_H_

#include <Eigen/SparseCholesky>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Order of elimination with the least fill in the factors. Large models use
// nested dissection (METIS), which halves the factors of minimum degree if the
// model is solid. Small models, and models for which METIS fails, use minimum
// degree (AMD).
struct FillReducingOrdering {
  // Signature required by Eigen.
  void operator()(const SparseMatrix& symmetric,
                  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>&
                      inverse) const;
};

// Factorisation P S (K - shift M) S P' = L D L'. The diagonal matrix S makes
// the diagonal of the matrix one, so that units, rotations and penalties do not
// matter. There is no pivoting. The signs of D give the inertia if the factors
// are accurate, which SolveError shows.
class ShiftedFactors {
 public:
  // Computes the factors. Returns false if a pivot is zero or not finite.
  [[nodiscard]] bool Factorise(const SparseMatrix& mass,
                               const SparseMatrix& stiffness, double shift);

  const Vector& pivots() const { return pivots_; }
  // Returns the DOF of a pivot.
  Eigen::Index DofOfPivot(Eigen::Index pivot) const;

  // Returns true if the matrix is positive definite beyond rounding.
  bool IsDefinite() const;
  Eigen::Index NumNegative() const { return (pivots_.array() < 0.0).count(); }

  // Returns the accuracy of a solution with these factors: the relative error
  // of the right side, in the scaled matrix.
  double SolveError(const SparseMatrix& mass, const SparseMatrix& stiffness,
                    double shift) const;

  // Returns (K - shift M)^-1 times each column of `right`.
  Matrix Solve(const Matrix& right) const;

  // Returns F^-T y with F = S^-1 P' L |D|^1/2. Hence F F' = K - shift M if that
  // is positive definite.
  Vector ToShape(const Vector& y) const;
  // Returns F^-1 f.
  Vector FromForce(const Vector& f) const;

 private:
  Vector scale_;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, FillReducingOrdering>
      solver_;
  Vector pivots_;
  Vector root_;
};

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_SHIFTED_FACTORS_H_
