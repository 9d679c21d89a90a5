// Propagates a long segment on several threads.

#ifndef PINODE_INTEGRATE_PARALLEL_SEGMENT_H_
#define PINODE_INTEGRATE_PARALLEL_SEGMENT_H_

#include <memory>
#include <vector>

#include "pinode/integrate/segment.h"

namespace pinode {

// First computes the states alone and in order, without derivatives. Pieces of
// the segment then compute their derivatives in parallel, including those with
// respect to their own starts. These are chained: d/ds_0 = (d/ds_p)
// (ds_p/ds_0). The result equals that of SegmentPropagator up to rounding.
class ParallelSegment {
 public:
  ParallelSegment(const StructuralDynamics& dynamics, DerivativeMethod method,
                  int num_threads);

  // Returns true if threads would save time. They do for long segments with
  // derivatives, if the derivatives with respect to the starts of pieces do not
  // add too much work.
  bool IsWorthwhile(const IntegrationGrid& grid, Eigen::Index first,
                    Eigen::Index last, SegmentColumns columns) const;

  // Does what SegmentPropagator::Propagate does.
  bool Propagate(const StructuralDynamics::Prepared& prepared,
                 const ObservationMap& observation, const IntegrationGrid& grid,
                 const Vector& start, Eigen::Index first, Eigen::Index last,
                 bool observe_last, SegmentColumns columns,
                 SegmentTangents* result);

 private:
  struct Piece {
    explicit Piece(const StructuralDynamics& dynamics, DerivativeMethod method)
        : propagator(dynamics, method) {}
    SegmentPropagator propagator;
    SegmentTangents tangents;
    Eigen::Index first = 0;
    Eigen::Index last = 0;
    bool ok = false;
  };

  void Chain(const ObservationMap& observation, Eigen::Index first,
             Eigen::Index samples, SegmentColumns columns,
             SegmentTangents* result);

  const StructuralDynamics& dynamics_;
  DerivativeMethod method_;
  std::vector<std::unique_ptr<Piece>> pieces_;  // one for each thread
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_PARALLEL_SEGMENT_H_
