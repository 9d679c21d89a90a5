// Trajectories of a problem as one residual block of a ceres::Problem.

#ifndef PINODE_ESTIMATE_TRAJECTORY_COST_H_
#define PINODE_ESTIMATE_TRAJECTORY_COST_H_

#include <ceres/cost_function.h>

#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/integrate/integrator.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/robust_loss.h"

namespace pinode {

// Trajectories of all training records, with the segments' starts projected out
// (MultipleShooting), as num_free + 1 residuals: see CondensedCost.
//
// The single parameter block holds the free parameters, in the order of
// layout(), which names them. Start from InitialValues(). Set their bounds in
// the ceres::Problem, where other residuals may share the block. Priors and
// measured modes are separate blocks: MakePriorCost, MakeModalCost. Without a
// Jacobian only |r|^2 is right: r cannot be differentiated numerically.
//
// Evaluations of one object must come one at a time, as Ceres does. With
// Options::num_threads each evaluation uses threads. Like other cost functions
// the object belongs to the ceres::Problem that it is added to.
class TrajectoryCost final : public ceres::CostFunction {
 public:
  struct Options {
    // Length of the segments in samples; 0: each record in one piece. Multiple
    // shooting reaches solutions that a long simulation misses. Gaps between
    // segments are then held, not closed: `gap_firmness` times as firmly as the
    // data hold the starts.
    Eigen::Index segment_samples = 0;
    double gap_firmness = 1e4;
    // Standard deviation of each channel, per training record. Empty: as given
    // in the problem, or 5 % of the channel's spread.
    std::vector<Vector> sigmas;
    DerivativeMethod derivatives = DerivativeMethod::kTangents;
    RobustLoss loss = RobustLoss::kNone;
    double loss_scale = 3.0;  // in units of sigma
    int num_threads = 1;
  };

  // Creates the cost of the training records of `problem`, which is copied.
  // Starts begin from a smoother on the problem's initial values. Returns
  // nullptr, with a sentence in *error, if problem or options are not valid or
  // no finite trajectory is found there.
  static std::unique_ptr<TrajectoryCost> Create(IdentificationProblem problem,
                                                const Options& options,
                                                std::string* error);

  ~TrajectoryCost() override;

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

  // Layout of the parameter block, and its values in the problem.
  const ParameterLayout& layout() const;
  Vector InitialValues() const;

 private:
  struct Owned;

  explicit TrajectoryCost(std::unique_ptr<Owned> owned);

  const std::unique_ptr<Owned> owned_;
};

// Returns the residuals of the priors of `layout`, which must outlive them.
// `decays`: precision of the zero-mean prior of each decay group (weights of a
// network); empty: no weight decay. nullptr if there is no prior.
std::unique_ptr<ceres::CostFunction> MakePriorCost(
    const ParameterLayout& layout, const Vector& decays = Vector());

// Returns the residuals of the measured modes of `problem`, which is valid.
// `layout` must outlive them. nullptr if there are no modes.
std::unique_ptr<ceres::CostFunction> MakeModalCost(
    const IdentificationProblem& problem, const ParameterLayout& layout);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_TRAJECTORY_COST_H_
