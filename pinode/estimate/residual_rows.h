// Predictions of a segment beside what was measured: weighted residuals and
// their derivatives.

#ifndef PINODE_ESTIMATE_RESIDUAL_ROWS_H_
#define PINODE_ESTIMATE_RESIDUAL_ROWS_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/identification_problem.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/estimate/robust_loss.h"
#include "pinode/integrate/segment.h"

namespace pinode {

// The columns of `tangents`, and, behind those of the dynamics' parameters,
// zeros for the sensors, which have no part in it.
void AddSensorColumns(const ParameterLayout& layout, int num_states,
                      SegmentColumns columns, const Matrix& tangents,
                      Matrix* result);

// With the residual r = (sensor's prediction - measured) / sigma of a sample
// and a loss rho(r^2), the weighted residual is r sqrt(rho'(r^2)): its square's
// gradient is the loss's. Samples that are missing, not fitted or outside of
// what a delayed sensor sees are rows of zeros.
class ResidualRows {
 public:
  // Both must outlive this object.
  ResidualRows(const IdentificationProblem& problem,
               const ParameterLayout& layout, RobustLoss loss,
               double loss_scale);

  // Of the samples from `first` on that `tangents` holds. `parameters`: all of
  // the problem's; `sigmas`: one per channel. A filter needs the whole history:
  // it is applied where `whole` says that these are all samples of the record.
  void Compute(const IdentificationRecord& record, const Vector& sigmas,
               const Vector& parameters, Eigen::Index first, bool whole,
               SegmentColumns columns, const SegmentTangents& tangents);

  // Half the sum of rho(r^2).
  double cost() const { return cost_; }
  // channels * samples, channels fastest.
  const Vector& residuals() const { return residuals_; }
  // As many rows; columns as AddSensorColumns has them.
  const Matrix& jacobian() const { return jacobian_; }
  // Hands both over, without a copy.
  void Swap(Vector* residuals, Matrix* jacobian) {
    residuals_.swap(*residuals);
    jacobian_.swap(*jacobian);
  }

 private:
  const IdentificationProblem& problem_;
  const ParameterLayout& layout_;
  RobustLoss loss_;
  double loss_scale_;
  double cost_ = 0.0;
  Vector residuals_;
  Matrix jacobian_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_RESIDUAL_ROWS_H_
