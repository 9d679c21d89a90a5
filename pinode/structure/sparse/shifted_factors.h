// Sparse factors of K - shift M. Not meant for other floors.

#ifndef PINODE_STRUCTURE_SPARSE_SHIFTED_FACTORS_H_
#define PINODE_STRUCTURE_SPARSE_SHIFTED_FACTORS_H_

#include <Eigen/SparseCholesky>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// The order of elimination that fills the factors least: nested dissection
// (METIS) for large models, whose factors it makes twice as small as minimum
// degree does where they are solid; minimum degree (AMD) for small ones, and
// where METIS gives up.
struct FillReducingOrdering {
  // As Eigen calls it.
  void operator()(const SparseMatrix& symmetric,
                  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>&
                      inverse) const;
};

// P S (K - shift M) S P' = L D L', with S a diagonal that makes the diagonal of
// the matrix one, so that units, rotations and penalties do not matter. Without
// pivoting: the signs of D are the inertia where the factors are of use, which
// SolveError tells.
class ShiftedFactors {
 public:
  // False if a pivot is zero or not finite.
  [[nodiscard]] bool Factorise(const SparseMatrix& mass,
                               const SparseMatrix& stiffness, double shift);

  const Vector& pivots() const { return pivots_; }
  // The DOF of a pivot.
  Eigen::Index DofOfPivot(Eigen::Index pivot) const;

  // Positive definite beyond rounding.
  bool IsDefinite() const;
  Eigen::Index NumNegative() const { return (pivots_.array() < 0.0).count(); }

  // How well the factors solve a system: the relative error of the right side,
  // in the scaled matrix.
  double SolveError(const SparseMatrix& mass, const SparseMatrix& stiffness,
                    double shift) const;

  // (K - shift M)^-1 times each column.
  Matrix Solve(const Matrix& right) const;

  // F^-T y with F = S^-1 P' L |D|^1/2, hence F F' = K - shift M where that is
  // positive definite.
  Vector ToShape(const Vector& y) const;
  // F^-1 f.
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
