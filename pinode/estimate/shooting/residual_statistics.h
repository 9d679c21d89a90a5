// Residuals of all training records, and the products that statistics need.

#ifndef PINODE_ESTIMATE_SHOOTING_RESIDUAL_STATISTICS_H_
#define PINODE_ESTIMATE_SHOOTING_RESIDUAL_STATISTICS_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/shooting/multiple_shooting.h"

namespace pinode {

// Weighted residuals (yhat - y) / sigma, as
// MultipleShooting::VisitWeightedResiduals has them: channels x samples per
// training record. With `with_jacobian` also their derivative by the free
// parameters, (channels * samples) x num_free, channels fastest. False where a
// trajectory is not finite.
[[nodiscard]] bool WeightedResiduals(const Vector& free, bool with_jacobian,
                                     MultipleShooting* shooting,
                                     std::vector<Matrix>* residuals,
                                     std::vector<Matrix>* jacobians);

// J'J of the weighted residuals at the last Linearize.
Matrix ResidualInformation(const MultipleShooting& shooting);

// The two functions below need records that are linear and in one piece
// (SegmentSweep::IsByModes). They do not look at each sample's derivatives.

// r + J step, channels x samples per training record; J is the Jacobian of
// WeightedResiduals. False where a trajectory is not finite.
[[nodiscard]] bool MovedResiduals(const MultipleShooting& shooting,
                                  const Vector& free, const Vector& step,
                                  std::vector<Matrix>* residuals);
// Adds the lower triangle of sum g g' to *products and the number of terms to
// *count; g = J'r of each block of lengths[r] samples of training record r.
[[nodiscard]] bool AddScores(const MultipleShooting& shooting,
                             const Vector& free,
                             const std::vector<Eigen::Index>& lengths,
                             Matrix* products, double* count);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_RESIDUAL_STATISTICS_H_
