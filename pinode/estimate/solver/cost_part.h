// Parts of which the cost of a fit is the sum.

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

  // Adds the terms of another cost.
  void Add(const CondensedSystem& other) {
    cost += other.cost;
    gradient += other.gradient;
    hessian += other.hessian;
  }
};

// One part of the cost: trajectories (MultipleShooting), priors (PriorCost),
// measured modes (ModalCost). Objective sums the parts for the evidence and the
// covariance.
class CostPart {
 public:
  virtual ~CostPart() = default;

  // Computes the cost at `free`, the free parameters in the order of
  // ParameterLayout. Returns false if it is not finite or not available, see
  // Failure().
  [[nodiscard]] virtual bool Evaluate(const Vector& free, double* cost) = 0;
  // Computes the cost and its derivatives.
  [[nodiscard]] virtual bool Linearize(const Vector& free,
                                       CondensedSystem* system) = 0;
  // Reason for the failure of the last evaluation, a sentence; empty: no
  // failure.
  virtual std::string Failure() const = 0;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_COST_PART_H_
