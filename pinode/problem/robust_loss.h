// Losses that grow more slowly than the square.

#ifndef PINODE_PROBLEM_ROBUST_LOSS_H_
#define PINODE_PROBLEM_ROBUST_LOSS_H_

namespace pinode {

enum class RobustLoss { kNone, kHuber, kCauchy };

// Computes rho(s) and its derivative for s = (r / sigma)^2, with b = scale^2:
//
//   none     s
//   Huber    s for s <= b, else 2 sqrt(b s) - b
//   Cauchy   b log(1 + s / b)
//
// As in ceres/loss_function.h, but for single samples instead of whole residual
// blocks. All have rho' s <= rho.
void EvaluateRobustLoss(RobustLoss loss, double scale, double s, double* rho,
                        double* slope);

}  // namespace pinode

#endif  // PINODE_PROBLEM_ROBUST_LOSS_H_
