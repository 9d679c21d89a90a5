// Minimum of a quadratic cost over some of its unknowns.

#ifndef PINODE_DISCOVER_QUADRATIC_FACE_H_
#define PINODE_DISCOVER_QUADRATIC_FACE_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Negative log-likelihood near its minimum,
//
//   f(theta) = gradient' theta + 1/2 theta' hessian theta + constant,
//
// such as that of multiple shooting for the coefficients of a library in the
// equation of motion. There theta = 0 is the model without the candidates.
struct QuadraticCost {
  Vector gradient;  // at theta = 0
  Matrix hessian;   // positive semidefinite
};

// Returns the scale of each unknown for which the Hessian has a unit diagonal;
// 0 where the cost does not depend on it.
Vector UnitDiagonalScales(const QuadraticCost& cost);

// Returns the cost as a function of theta / scales.
QuadraticCost ScaledCost(const QuadraticCost& cost, const Vector& scales);

// Minimum over the entries of a support, of a cost that is scaled to a unit
// diagonal, with the values of 2 f after one more entry, one fewer, or both.
class QuadraticFace {
 public:
  QuadraticFace(const QuadraticCost& scaled, std::vector<int> support);

  const std::vector<int>& support() const { return support_; }
  const Vector& solution() const { return solution_; }
  // Returns 2 f at the minimum, less the constant.
  double twice_cost() const { return twice_cost_; }

  // Returns the increase of 2 f without the a-th entry.
  double Loss(Eigen::Index a) const {
    return solution_[a] * solution_[a] / inverse_diagonal_[a];
  }

  // Returns the decrease of 2 f with entry j, after the a-th has gone (-1:
  // none), and its value. 0 if it depends on those taken.
  double Gain(int j, Eigen::Index a, double* value) const;

 private:
  int At(Eigen::Index a) const { return support_[static_cast<size_t>(a)]; }

  std::vector<int> support_;
  Vector solution_;
  Vector inverse_diagonal_;
  Matrix explained_;  // support x all: regression of all columns on the support
  Vector slopes_;     // of f at the minimum
  Vector curvatures_;  // beside the support
  double twice_cost_ = 0.0;
};

}  // namespace pinode

#endif  // PINODE_DISCOVER_QUADRATIC_FACE_H_
