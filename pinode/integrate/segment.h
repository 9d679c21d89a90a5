// One shooting segment: channels at its samples, the state at its end, and the
// derivatives of both with respect to the segment's start and the parameters.

#ifndef PINODE_INTEGRATE_SEGMENT_H_
#define PINODE_INTEGRATE_SEGMENT_H_

#include <memory>
#include <optional>

#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/exponential_step.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/integrator.h"
#include "pinode/integrate/linear_segment.h"
#include "pinode/integrate/tangent_step.h"

namespace pinode {

// Which derivatives are asked for: num_states columns by the start, then
// num_tangent_columns by the parameters.
enum class SegmentColumns { kNone, kStart, kParameters, kAll };

inline bool HasStart(SegmentColumns columns) {
  return columns == SegmentColumns::kStart || columns == SegmentColumns::kAll;
}
inline bool HasParameters(SegmentColumns columns) {
  return columns == SegmentColumns::kParameters ||
         columns == SegmentColumns::kAll;
}

struct SegmentTangents {
  Matrix channels;  // num_channels x samples observed
  // Derivatives, (num_channels * samples) x columns, channels fastest, each
  // channel's times its factor.
  auto jacobian() {
    return rows.middleCols(columns_before,
                           rows.cols() - columns_before - columns_behind);
  }
  auto jacobian() const {
    return rows.middleCols(columns_before,
                           rows.cols() - columns_before - columns_behind);
  }
  Vector end_state;        // num_states
  Matrix end_sensitivity;  // num_states x columns
  // Sample and index of the first state that was not finite; -1 if all are
  // finite.
  Eigen::Index failed_sample = -1;
  int failed_state = -1;

  // Number of columns before the derivatives, and factors of the channels. The
  // caller may set them before the call if it needs more columns around the
  // derivatives, which are left unchanged, or derivatives times a factor, e.g.
  // 1 / sigma. A separate pass over all derivatives would take longer.
  Eigen::Index columns_before = 0;
  Eigen::Index columns_behind = 0;
  Vector factors;  // empty: 1
  Matrix rows;     // holds jacobian()

  void ResizeJacobian(Eigen::Index num_rows, Eigen::Index columns) {
    rows.resize(num_rows, columns_before + columns + columns_behind);
  }
  // Applies the factors to derivatives that were written without them.
  void ApplyFactors();
};

// Returns the index of the first state that is too large or not a number; -1:
// none.
int FirstNotFinite(const Vector& state);

// Propagates segments of one dynamics. Owns the working memory; use one object
// per thread.
class SegmentPropagator {
 public:
  SegmentPropagator(const StructuralDynamics& dynamics,
                    DerivativeMethod method);

  // Integrates from `start` at sample `first` to sample `last` (at most
  // grid.num_intervals()). Observes the samples in [first, last), and `last`
  // itself if observe_last. Returns false if a state is not finite.
  bool Propagate(const StructuralDynamics::Prepared& prepared,
                 const ObservationMap& observation, const IntegrationGrid& grid,
                 const Vector& start, Eigen::Index first, Eigen::Index last,
                 bool observe_last, SegmentColumns columns,
                 SegmentTangents* result);

 private:
  // Computes values alone, by steps without derivatives.
  bool Run(const StructuralDynamics::Prepared& prepared,
           const ObservationMap& observation, const IntegrationGrid& grid,
           const Vector& start, Eigen::Index first, Eigen::Index last,
           bool observe_last, SegmentTangents* result);
  bool PropagateTangents(const StructuralDynamics::Prepared& prepared,
                         const ObservationMap& observation,
                         const IntegrationGrid& grid, const Vector& start,
                         Eigen::Index first, Eigen::Index last,
                         bool observe_last, SegmentColumns columns,
                         SegmentTangents* result);

  const StructuralDynamics& dynamics_;
  DerivativeMethod method_;
  LinearSegment linear_;
  std::optional<ExponentialStep> exponential_;  // created on request
  TangentStep step_;
  Vector state_;
  Matrix sensitivity_;
  Matrix state_jacobian_;
  Matrix direct_;  // acceleration rows x parameter columns
};

// Does the same with Jets (jet_segment.cc). It is slow and serves as the
// reference for the tangents.
bool PropagateWithJets(const StructuralDynamics& dynamics,
                       const StructuralDynamics::Prepared& prepared,
                       const ObservationMap& observation,
                       const IntegrationGrid& grid, const Vector& start,
                       Eigen::Index first, Eigen::Index last, bool observe_last,
                       SegmentColumns columns, SegmentTangents* result);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_SEGMENT_H_
