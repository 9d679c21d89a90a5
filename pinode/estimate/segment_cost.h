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

// Residuals of a segment that starts in state s at sample `first` and ends in
// phi(s, theta) at sample `last`. s_next is the start of the next segment,
//
//   (prediction - measured) / sigma     channels x samples, samples
//                                       first ... last - 1, channels fastest
//   (phi(s, theta) - s_next) / gap_sigma     num_states
//
// Parameter blocks: s (num_states), s_next (num_states), and the free
// parameters in the order of ParameterLayout. The last segment of a record also
// has residuals at `last`. It has no gap and no block for a next start: its
// blocks are s and the free parameters.
//
// TrajectoryCost expresses all segments of a problem, without multipliers, in
// one block without the starts. This class is for problems in which the starts
// are visible. If a record's first start is known, make its block constant
// (SetParameterBlockConstant). Residuals are zero for samples that are missing,
// not fitted or outside the range of a delayed sensor.
//
// Objects share no writable memory: Ceres may evaluate as many at once as it
// has threads. Each belongs to the ceres::Problem that it is added to.
class SegmentCost final : public ceres::CostFunction {
 public:
  struct Options {
    // Standard deviations of the channels. Empty: as given in the problem, or 5
    // % of the channel's spread.
    Vector sigmas;
    // Standard deviations of the gaps, one per state. Empty: 1e-3 of each
    // state's size as guessed from the record.
    Vector gap_sigmas;
    // Both methods give the derivatives of the discrete steps. Jets through
    // Runge-Kutta take many times as long.
    DerivativeMethod derivatives = DerivativeMethod::kTangents;
  };

  // Keeps a reference to `problem`, which must outlive the object; `record` is
  // an index into its records. Returns nullptr, with a sentence in *error, if
  // the problem, the samples (0 <= first < last < num_samples) or the options
  // are not valid. The same if the record has a filter and this is only a part
  // of it, because a filter needs the whole history.
  static std::unique_ptr<SegmentCost> Create(
      const IdentificationProblem& problem, int record, Eigen::Index first,
      Eigen::Index last, const Options& options, std::string* error);

  // Adds a whole record to `ceres_problem`: multiple shooting with segments of
  // `length` samples, the last one with the remaining samples. Each segment is
  // a residual block. Each column of *starts (num_states x segments) is the
  // parameter block of a start, and all segments share the block `free`. Both
  // must outlive `ceres_problem`.
  //
  // *starts is set to states from displacements and velocities at single DOFs,
  // and to 0 for other states. The first start is constant if the record's
  // start is known or at rest.
  //
  // Returns false, with a sentence in *error and nothing added, as Create does.
  [[nodiscard]] static bool AddRecord(const IdentificationProblem& problem,
                                      int record, Eigen::Index length,
                                      const Options& options, double* free,
                                      Matrix* starts,
                                      ceres::Problem* ceres_problem,
                                      std::string* error);

  ~SegmentCost() override;

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
