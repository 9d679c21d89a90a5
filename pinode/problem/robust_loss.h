// Robust losses, which grow more slowly than the square.

#ifndef PINODE_PROBLEM_ROBUST_LOSS_H_
#define PINODE_PROBLEM_ROBUST_LOSS_H_

namespace pinode {

// Loss function of a residual.
enum class RobustLoss { kNone, kHuber, kCauchy };

// Computes rho(s) and its derivative `slope` for s = (r / sigma)^2, with b =
// scale^2. All are dimensionless.
//
//   none     s
//   Huber    s for s <= b, else 2 sqrt(b s) - b
//   Cauchy   b log(1 + s / b)
//
// These are the losses of ceres/loss_function.h, applied to single samples
// instead of residual blocks. For all of them rho' s <= rho.
void EvaluateRobustLoss(RobustLoss loss, double scale, double s, double* rho,
                        double* slope);

}  // namespace pinode

#endif  // PINODE_PROBLEM_ROBUST_LOSS_H_
