// Modes with an error bound, from eigenpairs of the inverse operator. Not meant
// for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_CHECKED_MODES_H_
#define PINODE_STRUCTURE_SPARSE_CHECKED_MODES_H_

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/shifted_factors.h"

namespace pinode {

// Required accuracy of each eigenvalue.
inline constexpr double kLargestErrorBound = 1e-8;

// Eigenpairs of the inverse operator, theta descending (w^2 ascending).
struct InversePairs {
  Vector theta;
  Matrix vectors;  // orthonormal columns
  // True if all eigenvalues beside these are zero.
  bool are_all = false;
};

// One mode. Its shape has phi' M phi = 1.
struct CheckedMode {
  double eigenvalue = 0.0;
  Vector shape;
  // Bound of the relative error of the eigenvalue.
  double bound = 0.0;
  // Residual of the inverse operator in parts of theta. Modes with small ones
  // are orthogonal, whatever their bounds.
  double residual = 0.0;
  // Sum of the parts, by magnitude, that cancel in phi' K phi.
  double parts = 0.0;
};

// Largest stiffness of a rigid-body motion, in parts of the terms that cancel
// in it: the rounding in files of 13 digits, if nothing holds the structure. A
// positive definite K that holds a mode more softly holds it all the same.
inline constexpr double kRigidIfFree = 1e-12;
inline constexpr double kRigidIfHeld = 1e-14;

// A model at a shift, with the factors of K - shift M.
class ShiftedModel {
 public:
  // `factors`: those of the positive definite K, or nullptr.
  ShiftedModel(const SparseMatrix& mass, const SparseMatrix& stiffness,
               const std::vector<int>& held,
               std::unique_ptr<ShiftedFactors> factors)
      : mass_(mass),
        stiffness_(stiffness),
        held_(held),
        factors_(std::move(factors)) {}

  const SparseMatrix& mass() const { return mass_; }
  const SparseMatrix& stiffness() const { return stiffness_; }
  const std::vector<int>& held() const { return held_; }
  double shift() const { return shift_; }
  // A frequency squared that is small for the model, 1 / time^2.
  double unit() const { return unit_; }
  const ShiftedFactors& factors() const { return *factors_; }
  // Orthonormal columns that span F^-1 e, see InverseOperator.
  const Matrix& held_directions() const { return held_directions_; }

  // Chooses 0 if K is positive definite, otherwise a shift below the lowest
  // eigenvalue. It starts from a thousandth of the frequency at which the
  // softest DOF would vibrate alone.
  [[nodiscard]] bool ChooseShift(std::string* error);

  // Moves to the power of two at or below the size of `shift`, which is
  // negative. Returns false, and stays, if K - shift M is not positive definite
  // there beyond rounding.
  [[nodiscard]] bool MoveTo(double shift);

  // Returns the factors if the shift is zero, otherwise nullptr.
  std::unique_ptr<ShiftedFactors> TakeFactors() {
    return shift_ == 0.0 ? std::move(factors_) : nullptr;
  }

  // Unit forces on the held DOFs, n x held DOFs.
  Matrix ForcesOnHeld() const;

  // Finds eigenvalue and shape of a pair, with Rayleigh's quotient instead of
  // theta: its error is the square of the shape's. The error bounds are those
  // of the residual and of G. Temple and T. Kato (B. N. Parlett, The Symmetric
  // Eigenvalue Problem, SIAM 1998, section 10.5), in the inverse operator.
  CheckedMode Check(const InversePairs& pairs, Eigen::Index i) const;

  // Returns true if the stiffness of a mode is rounding. `is_held`: K is
  // positive definite.
  static bool IsRigid(const CheckedMode& mode, bool is_held) {
    return std::abs(mode.eigenvalue) <=
           (is_held ? kRigidIfHeld : kRigidIfFree) * mode.parts;
  }

 private:
  void FindHeldDirections();

  const SparseMatrix& mass_;
  const SparseMatrix& stiffness_;
  const std::vector<int>& held_;
  double shift_ = 0.0;
  double unit_ = 1.0;
  std::unique_ptr<ShiftedFactors> factors_;
  Matrix held_directions_;
};

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_CHECKED_MODES_H_
