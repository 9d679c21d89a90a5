// One shooting segment as a residual block of a ceres::Problem.

#ifndef PINODE_ESTIMATE_SEGMENT_COST_H_
#define PINODE_ESTIMATE_SEGMENT_COST_H_

#include <ceres/cost_function.h>

#include <memory>
#include <string>

#include "pinode/base/types.h"
#include "pinode/integrate/integrator.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// The residuals of a segment that starts in state s at sample `first` and ends
// in phi(s, theta) at sample `last`, s_next being the start of the one behind
// it,
//
//   (prediction - measured) / sigma     channels x samples, samples
//                                       first ... last - 1, channels fastest
//   (phi(s, theta) - s_next) / gap_sigma     num_states
//
// Parameter blocks: s (num_states), s_next (num_states), and the free
// parameters in the order of ParameterLayout. The last segment of a record has
// residuals at `last` too, no gap, and no block for a next start: s and the
// free parameters alone.
//
// All that a problem's blocks of segments say together, with multipliers left
// out, is what TrajectoryCost says in one block without the starts; this is the
// plain way, for problems in which the starts are to be seen. A record's first
// start is a constant block where it is known (SetParameterBlockConstant).
// Residuals of samples that are missing, not fitted or outside of what a
// delayed sensor sees are zero.
//
// Objects do not share what they write: Ceres may evaluate as many at once as
// it has threads. Each belongs to the ceres::Problem that it is added to.
class SegmentCost final : public ceres::CostFunction {
 public:
  struct Options {
    // Standard deviations of the channels; empty: as given in the problem, or
    // 5 % of the channel's spread.
    Vector sigmas;
    // Of the gaps, one per state; empty: 1e-3 of each state's size as it can
    // be guessed from the record.
    Vector gap_sigmas;
    // Both give the derivatives of the discrete steps; Jets through
    // Runge-Kutta take many times as long.
    DerivativeMethod derivatives = DerivativeMethod::kTangents;
  };

  // `problem` must outlive the object; `record` is an index into its records.
  // nullptr, with a sentence in *error, where the problem, the samples (0 <=
  // first < last < num_samples) or the options are not valid, or where the
  // record has a filter, which needs its whole history, and this is a part.
  static std::unique_ptr<SegmentCost> Create(
      const IdentificationProblem& problem, int record, Eigen::Index first,
      Eigen::Index last, const Options& options, std::string* error);

  ~SegmentCost() override;

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

  // Whether there is a next start.
  bool HasGap() const;

 private:
  struct Owned;

  explicit SegmentCost(std::unique_ptr<Owned> owned);

  const std::unique_ptr<Owned> owned_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SEGMENT_COST_H_
