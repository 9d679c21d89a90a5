#include "pinode/problem/robust_loss.h"

#include <cmath>

namespace pinode {

void EvaluateRobustLoss(RobustLoss loss, double scale, double s, double* rho,
                        double* slope) {
  const double b = scale * scale;
  *rho = s;
  *slope = 1.0;
  switch (loss) {
    case RobustLoss::kNone:
      return;
    case RobustLoss::kHuber:
      if (s > b) {
        *rho = 2.0 * scale * std::sqrt(s) - b;
        *slope = scale / std::sqrt(s);
      }
      return;
    case RobustLoss::kCauchy:
      *rho = b * std::log1p(s / b);
      *slope = 1.0 / (1.0 + s / b);
      return;
  }
}

}  // namespace pinode
