// What Ceres sees of a trajectory fit: one residual block over the free
// parameters.

#ifndef PINODE_ESTIMATE_CONDENSED_COST_H_
#define PINODE_ESTIMATE_CONDENSED_COST_H_

#include <ceres/cost_function.h>

#include "pinode/estimate/multiple_shooting.h"

namespace pinode {

// The projected problem f(theta) of MultipleShooting as num_free + 1 residuals.
// With gradient g and Gauss-Newton Hessian H = R'R,
//
//   r = [R^-T g; sqrt(2 f - |R^-T g|^2)],   J = [R; 0],
//
// so that |r|^2 / 2 = f, J'r = g and J'J = H: Levenberg-Marquardt takes the
// steps that it would take on the thousands of residuals behind H, and its
// linear algebra no longer grows with the records.
//
// Evaluations must come one at a time (Ceres with one residual block).
class CondensedCost final : public ceres::CostFunction {
 public:
  // `shooting` must outlive this object.
  CondensedCost(MultipleShooting* shooting, int num_free);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

  double jacobian_seconds() const { return jacobian_seconds_; }
  int failed_evaluations() const { return failed_evaluations_; }
  const CondensedSystem& system() const { return system_; }

 private:
  MultipleShooting* shooting_;
  mutable CondensedSystem system_;
  mutable Matrix root_;
  mutable double jacobian_seconds_ = 0.0;
  mutable int failed_evaluations_ = 0;
};

// R (upper triangular) with R'R = H up to a relative diagonal shift no larger
// than needed to make H numerically positive definite. False where H is not
// finite.
bool SquareRoot(const Matrix& hessian, Matrix* root);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CONDENSED_COST_H_
