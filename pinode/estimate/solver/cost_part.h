// What the cost of a fit is a sum of.

#ifndef PINODE_ESTIMATE_SOLVER_COST_PART_H_
#define PINODE_ESTIMATE_SOLVER_COST_PART_H_

#include <string>

#include "pinode/base/types.h"

namespace pinode {

// Value, gradient and Gauss-Newton Hessian of a cost by the free parameters.
// For trajectories these are the normal equations after the starts are
// eliminated.
struct CondensedSystem {
  double cost = 0.0;
  Vector gradient;  // num_free
  Matrix hessian;   // num_free x num_free, both triangles

  // Those of a sum of costs.
  void Add(const CondensedSystem& other) {
    cost += other.cost;
    gradient += other.gradient;
    hessian += other.hessian;
  }
};

// One part: trajectories (MultipleShooting), priors (PriorCost), measured modes
// (ModalCost). What needs all of them, as the evidence and the covariance do,
// sums them up (Objective).
class CostPart {
 public:
  virtual ~CostPart() = default;

  // The cost at `free`, the free parameters in the order of ParameterLayout.
  // False where it is not finite or cannot be had, see Failure().
  [[nodiscard]] virtual bool Evaluate(const Vector& free, double* cost) = 0;
  // The same, and its derivatives.
  [[nodiscard]] virtual bool Linearize(const Vector& free,
                                       CondensedSystem* system) = 0;
  // Why the last evaluation failed, a sentence; empty: it did not.
  virtual std::string Failure() const = 0;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_COST_PART_H_
