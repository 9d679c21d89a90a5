// Shooting segments as residual blocks of a ceres::Problem.

#ifndef PINODE_ESTIMATE_SEGMENT_COST_H_
#define PINODE_ESTIMATE_SEGMENT_COST_H_

#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <memory>
#include <string>

#include "pinode/base/types.h"
#include "pinode/integrate/integrator.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Residuals of one segment of multiple shooting (H. G. Bock 1981). The segment
// starts in the state s at sample `first` and ends in phi(s, theta) at sample
// `last`. s_next is the state in which the next segment starts. The residuals
// are dimensionless:
//
//   (prediction - measured) / sigma     channels x samples, samples
//                                       first ... last - 1, channels fastest
//   (phi(s, theta) - s_next) / gap_sigma     num_states
//
// The parameter blocks are s (num_states), s_next (num_states), and the free
// parameters in the order of ParameterLayout. The last segment of a record also
// has residuals at `last`. It has no gap residuals, and its blocks are only s
// and the free parameters.
//
// Use this class if the segments' starts are to be parameter blocks.
// TrajectoryCost eliminates them and needs one block only. If the first start
// of a record is known, make its block constant (SetParameterBlockConstant).
//
// Residuals are zero for samples that are missing, not fitted, or outside the
// range of a delayed sensor.
//
// Objects share no writable memory, so Ceres may evaluate several at once. The
// ceres::Problem that an object is added to owns it.
class SegmentCost final : public ceres::CostFunction {
 public:
  struct Options {
    // Standard deviation of the noise of each channel, in the channel's unit.
    // Empty: the value that the problem gives, or else 5 % of the standard
    // deviation of the channel's samples.
    Vector sigmas;
    // Standard deviations of the gaps, one per state, in its unit. Empty: 1e-3
    // of the size of each state, which is estimated from the record.
    Vector gap_sigmas;
    // Method for the derivatives. Both methods differentiate the discrete steps
    // and agree up to rounding. kJets is many times slower.
    DerivativeMethod derivatives = DerivativeMethod::kTangents;
  };

  // Creates the residuals of the samples `first` to `last` of a record, with 0
  // <= first < last < num_samples. `record` is an index into the problem's
  // records. The object keeps a reference to `problem`, which must outlive it.
  //
  // Returns nullptr, with a sentence in *error, if the problem, the samples or
  // the options are not valid. Also returns nullptr for a part of a record that
  // has a filter, because a filter needs the whole record.
  static std::unique_ptr<SegmentCost> Create(
      const IdentificationProblem& problem, int record, Eigen::Index first,
      Eigen::Index last, const Options& options, std::string* error);

  // Adds a whole record to `ceres_problem` in segments of `length` samples. The
  // last segment has the remaining samples. Each segment is a residual block.
  // Each column of *starts (num_states x segments) is the parameter block of
  // one start. All segments share the block `free` of the free parameters.
  // *starts and `free` must outlive `ceres_problem`.
  //
  // *starts is set to states taken from channels that measure the displacement
  // or velocity of single DOFs. Other states are set to 0. The first start is
  // made constant if the record's start is known or at rest.
  //
  // Adds nothing and returns false, with a sentence in *error, in the cases in
  // which Create returns nullptr.
  [[nodiscard]] static bool AddRecord(const IdentificationProblem& problem,
                                      int record, Eigen::Index length,
                                      const Options& options, double* free,
                                      Matrix* starts,
                                      ceres::Problem* ceres_problem,
                                      std::string* error);

  ~SegmentCost() override;

  // Computes residuals and Jacobians, see ceres::CostFunction. Returns false if
  // the segment's trajectory is not finite.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

  // True if there is a next start.
  bool HasGap() const;

 private:
  struct Owned;

  explicit SegmentCost(std::unique_ptr<Owned> owned);

  const std::unique_ptr<Owned> owned_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_SEGMENT_COST_H_
