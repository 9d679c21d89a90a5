// A shooting segment for linear dynamics.

#ifndef PINODE_INTEGRATE_LINEAR_SEGMENT_H_
#define PINODE_INTEGRATE_LINEAR_SEGMENT_H_

#include <optional>

#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/linear_map.h"

namespace pinode {

enum class SegmentColumns;
struct SegmentTangents;

// Propagates like SegmentPropagator, with LinearMap: the values and derivatives
// are equal up to rounding. Stores the map of the last parameters and steps.
// Use one object per thread.
class LinearSegment {
 public:
  explicit LinearSegment(const StructuralDynamics& dynamics)
      : dynamics_(dynamics) {}

  // Returns true if the dynamics are linear and the map's tables are not too
  // large.
  static bool Suits(const StructuralDynamics& dynamics, int substeps);

  // Does what SegmentPropagator::Propagate does.
  bool Propagate(const StructuralDynamics::Prepared& prepared,
                 const ObservationMap& observation, const IntegrationGrid& grid,
                 const Vector& start, Eigen::Index first, Eigen::Index last,
                 bool observe_last, SegmentColumns columns,
                 SegmentTangents* result);

 private:
  void UpdateMap(const StructuralDynamics::Prepared& prepared,
                 const IntegrationGrid& grid, bool with_parameters);
  // Computes the states at the samples `first` to `last`. Returns false if one
  // is not finite.
  bool Run(const IntegrationGrid& grid, const Vector& start, Eigen::Index first,
           Eigen::Index last, SegmentTangents* result);
  // Computes how the parameters move the states within one interval, for
  // `count` intervals from sample `begin` on: (num_states * parameters) x
  // count.
  void UpdateForcing(const IntegrationGrid& grid, Eigen::Index first,
                     Eigen::Index begin, Eigen::Index count);
  // Computes the parameters' direct effect on the acceleration channels,
  // (acceleration rows * parameters) x samples.
  void UpdateDirect(const ObservationMap& observation,
                    const IntegrationGrid& grid, Eigen::Index first,
                    Eigen::Index samples);

  const StructuralDynamics& dynamics_;
  std::optional<LinearMap> map_;
  Vector theta_;  // of map_
  double step_ = 0.0;
  int substeps_ = 0;
  Integrator integrator_ = Integrator::kRungeKutta;
  bool has_parameters_ = false;

  Matrix states_;  // num_states x samples
  Matrix nodes_;
  Matrix forcing_;  // see UpdateForcing
  Matrix direct_;   // see UpdateDirect
  Matrix sensitivity_;
  Matrix next_;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_LINEAR_SEGMENT_H_
