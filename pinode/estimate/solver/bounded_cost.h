// A cost as Levenberg-Marquardt wants it: free of units, and within bounds.

#ifndef PINODE_ESTIMATE_SOLVER_BOUNDED_COST_H_
#define PINODE_ESTIMATE_SOLVER_BOUNDED_COST_H_

#include <string>

#include "pinode/base/types.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// A cost f of the free parameters x by the unknowns y = x / scale:
//
//   scale   1 / sqrt(H_jj), H the Hessian at the point of departure, times a
//           constant and as a power of two, by which nothing is rounded; 1 of
//           weights, which have no unit. Steps and their limits then do not
//           depend on the units in which x is given.
//   bounds  What lies at a bound and would go on beyond it is held for the
//           step: its gradient is zero, and so are its products with others. A
//           step that leaves such unknowns in, and is cut off at the bound
//           afterwards, need not lower the cost however short it is (D. P.
//           Bertsekas, SIAM J. Control and Optimization 20 (1982) 221-246).
class BoundedCost final : public CostPart {
 public:
  // Linearises `part` at `start`, which is within the bounds; both must outlive
  // this object. IsValid() says whether that was possible.
  BoundedCost(const ParameterLayout& layout, const Vector& start,
              CostPart* part);
  bool IsValid() const { return valid_; }

  // Exactly, both ways.
  Vector Scaled(const Vector& free) const;
  Vector Unscaled(const Vector& scaled) const;
  // Of y; infinite where there is none.
  const Vector& lower() const { return lower_; }
  const Vector& upper() const { return upper_; }

  [[nodiscard]] bool Evaluate(const Vector& scaled, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& scaled,
                               CondensedSystem* system) override;
  std::string Failure() const override { return part_->Failure(); }
  // The newest linearisation of the part itself, not scaled.
  const CondensedSystem& system() const { return system_; }

 private:
  const ParameterLayout& layout_;
  CostPart* part_;
  bool valid_ = false;
  Vector scale_, lower_, upper_;
  // Of `part_`, and where.
  Vector at_;
  CondensedSystem system_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_BOUNDED_COST_H_
