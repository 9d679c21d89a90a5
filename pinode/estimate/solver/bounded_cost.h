// A cost for Levenberg-Marquardt: free of units, and within bounds.

#ifndef PINODE_ESTIMATE_SOLVER_BOUNDED_COST_H_
#define PINODE_ESTIMATE_SOLVER_BOUNDED_COST_H_

#include <string>

#include "pinode/base/types.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// A cost f of the free parameters x, in terms of the unknowns y = x / scale:
//
//   scale   1 / sqrt(H_jj), H the Hessian at the start, times a constant and as
//           a power of two, which causes no rounding; 1 for weights, which have
//           no unit. Steps and their limits then do not depend on the units of
//           x.
//   bounds  An unknown at a bound that would move beyond it is held for the
//           step: its gradient is zero, and so are its products with others. A
//           step that includes such unknowns, and is cut off at the bound
//           afterwards, need not lower the cost however short it is (D. P.
//           Bertsekas, SIAM J. Control and Optimization 20 (1982) 221-246).
class BoundedCost final : public CostPart {
 public:
  // Linearises `part` at `start`, which is within the bounds. `layout` and
  // `part` must outlive this object. IsValid() tells if it succeeded.
  BoundedCost(const ParameterLayout& layout, const Vector& start,
              CostPart* part);
  bool IsValid() const { return valid_; }

  // Convert exactly, in both directions.
  Vector Scaled(const Vector& free) const;
  Vector Unscaled(const Vector& scaled) const;
  // Bounds of y; infinite without a bound.
  const Vector& lower() const { return lower_; }
  const Vector& upper() const { return upper_; }

  [[nodiscard]] bool Evaluate(const Vector& scaled, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& scaled,
                               CondensedSystem* system) override;
  std::string Failure() const override { return part_->Failure(); }
  // Newest linearisation of the part itself, not scaled.
  const CondensedSystem& system() const { return system_; }

 private:
  const ParameterLayout& layout_;
  CostPart* part_;
  bool valid_ = false;
  Vector scale_, lower_, upper_;
  // Linearisation of `part`, and its point.
  Vector at_;
  CondensedSystem system_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_BOUNDED_COST_H_
