// Predictions of a segment beside what was measured: weighted residuals and
// their derivatives.

#ifndef PINODE_ESTIMATE_SHOOTING_RESIDUAL_ROWS_H_
#define PINODE_ESTIMATE_SHOOTING_RESIDUAL_ROWS_H_

#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/integrate/segment.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/robust_loss.h"

namespace pinode {

// The columns of `tangents`, and, behind those of the dynamics' parameters,
// zeros for the sensors, which have no part in it.
void AddSensorColumns(const ParameterLayout& layout, int num_states,
                      SegmentColumns columns, const Matrix& tangents,
                      Matrix* result);

// Weighted residuals of a segment, channels * samples, channels fastest, and
// their derivatives by start (where it is free) and free parameters: side by
// side, so that one product has the sums of both.
struct SegmentRows {
  // Columns of zeros, the derivatives, and the residuals.
  Matrix values;
  Eigen::Index first = 0;  // of the derivatives

  bool IsEmpty() const { return values.cols() == 0; }
  auto jacobian() const {
    return values.middleCols(first, values.cols() - 1 - first);
  }
  auto residuals() const { return values.col(values.cols() - 1); }
};

// So many columns, or up to three more: products by four columns at a time take
// a fifth longer where one is left over.
constexpr Eigen::Index WholeFours(Eigen::Index columns) {
  return (columns + 3) / 4 * 4;
}

// With the residual r = (sensor's prediction - measured) / sigma of a sample
// and a loss rho(r^2), the weighted residual is r sqrt(rho'(r^2)): its square's
// gradient is the loss's. Samples that are missing, not fitted or outside of
// what a delayed sensor sees are rows of zeros.
class ResidualRows {
 public:
  // `layout` must outlive this object.
  ResidualRows(const ParameterLayout& layout, RobustLoss loss,
               double loss_scale);

  // How Compute wants a segment's derivatives to be propagated.
  void Prepare(const IdentificationRecord& record, const Vector& sigmas,
               bool whole, int num_states, SegmentColumns columns,
               SegmentTangents* tangents) const;

  // Computes the rows of the samples from `first` on that `tangents` holds, as
  // Prepare has asked for them. `parameters`: all of the problem's; `sigmas`:
  // one per channel. A filter needs the whole history: it is applied if
  // `whole`, that is, if these are all samples of the record.
  void Compute(const IdentificationRecord& record, const Vector& sigmas,
               const Vector& parameters, Eigen::Index first, bool whole,
               SegmentColumns columns, SegmentTangents* tangents);

  // Half the sum of rho(r^2).
  double cost() const { return cost_; }
  // Columns of the derivatives as AddSensorColumns has them.
  const SegmentRows& rows() const { return rows_; }
  // Hands them over, without a copy.
  void Swap(SegmentRows* rows) { std::swap(rows_, *rows); }

 private:
  const ParameterLayout& layout_;
  RobustLoss loss_;
  double loss_scale_;
  double cost_ = 0.0;
  SegmentRows rows_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SHOOTING_RESIDUAL_ROWS_H_
