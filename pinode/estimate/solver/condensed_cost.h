// A part of the cost as one residual block for Ceres.

#ifndef PINODE_ESTIMATE_SOLVER_CONDENSED_COST_H_
#define PINODE_ESTIMATE_SOLVER_CONDENSED_COST_H_

#include <ceres/cost_function.h>
#include <ceres/types.h>

#include "pinode/base/types.h"
#include "pinode/estimate/solver/cost_part.h"

namespace pinode {

// A cost f of the free parameters as num_free + 1 residuals. With gradient g
// and Gauss-Newton Hessian H = R'R,
//
//   r = [R^-T g; sqrt(2 f - |R^-T g|^2)],   J = [R; 0],
//
// so that |r|^2 / 2 = f, J'r = g and J'J = H. Levenberg-Marquardt takes the
// same steps as on the thousands of residuals behind H, and its linear algebra
// does not grow with the records. Without a Jacobian only |r|^2 is right: r
// cannot be differentiated numerically.
//
// R requires H to be positive definite up to rounding. The trajectories alone
// may leave directions in which H is pure rounding error, above all for a
// network. With the priors they do not: the library's own solve uses the whole
// Objective.
//
// Evaluations of one object must come one at a time, as Ceres does.
class CondensedCost final : public ceres::CostFunction {
 public:
  // Keeps a reference to `part`, which must outlive this object.
  CondensedCost(CostPart* part, int num_free);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

  double jacobian_seconds() const { return jacobian_seconds_; }
  int failed_evaluations() const { return failed_evaluations_; }

 private:
  bool EvaluateWithJacobian(const Vector& free, double* residuals,
                            double* jacobian) const;

  CostPart* part_;
  mutable CondensedSystem system_;
  mutable Matrix root_;
  mutable double jacobian_seconds_ = 0.0;
  mutable int failed_evaluations_ = 0;
};

// Returns Ceres' solver for such a block. Up to a hundred unknowns it is the
// more accurate one, whose time is negligible there.
ceres::LinearSolverType DenseSolverFor(int num_free);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SOLVER_CONDENSED_COST_H_
