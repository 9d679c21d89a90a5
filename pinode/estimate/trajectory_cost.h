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

// Residuals of the trajectories of all training records. The starts of the
// segments are eliminated (MultipleShooting). The cost is condensed to num_free
// + 1 residuals with the same value, gradient and Gauss-Newton Hessian, see
// CondensedCost.
//
// The only parameter block holds the free parameters, in the order and with the
// names of layout(). Start from InitialValues(). Set bounds in the
// ceres::Problem. Other residual blocks may share the parameter block. Priors
// and measured modes are such blocks, see MakePriorCost and MakeModalCost.
//
// If no Jacobian is requested, only |r|^2 is right. Therefore r cannot be
// differentiated numerically.
//
// Evaluate one object by one thread at a time, as Ceres does. Each evaluation
// uses Options::num_threads threads of its own. The ceres::Problem that the
// object is added to owns it.
class TrajectoryCost final : public ceres::CostFunction {
 public:
  struct Options {
    // Length of the segments in samples; 0: each record is one segment.
    // Segments (multiple shooting) reach solutions that one long simulation
    // misses.
    Eigen::Index segment_samples = 0;
    // Weight of the gaps between segments, relative to the weight with which
    // the data determine the starts. The gaps are small but not zero.
    double gap_firmness = 1e4;
    // Standard deviation of the noise of each channel, one vector per training
    // record, in the channels' units. Empty: the value that the problem gives,
    // or else 5 % of the standard deviation of the channel's samples.
    std::vector<Vector> sigmas;
    // Method for the derivatives, and loss function of the residuals.
    DerivativeMethod derivatives = DerivativeMethod::kTangents;
    RobustLoss loss = RobustLoss::kNone;
    // Size, in units of sigma, beyond which residuals count less.
    double loss_scale = 3.0;
    int num_threads = 1;
  };

  // Creates the cost of the training records of `problem`, which is copied. The
  // first guess of the starts is from a smoother that uses the problem's
  // initial values. Returns nullptr, with a sentence in *error, if problem or
  // options are not valid. Also returns nullptr if no finite trajectory is
  // found at the initial values.
  static std::unique_ptr<TrajectoryCost> Create(IdentificationProblem problem,
                                                const Options& options,
                                                std::string* error);

  ~TrajectoryCost() override;

  // Computes residuals and Jacobian, see ceres::CostFunction. Returns false if
  // a trajectory is not finite.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

  // Layout of the parameter block, and the initial values in the problem, one
  // per free parameter.
  const ParameterLayout& layout() const;
  Vector InitialValues() const;

 private:
  struct Owned;

  explicit TrajectoryCost(std::unique_ptr<Owned> owned);

  const std::unique_ptr<Owned> owned_;
};

// Returns the residuals of the priors on the parameters of `layout`. Returns
// nullptr if there is no prior. `layout` must outlive the result. `decays` has
// the precision (1 / variance) of the zero-mean prior of each decay group, such
// as the weights of a network. Empty: no weight decay.
std::unique_ptr<ceres::CostFunction> MakePriorCost(
    const ParameterLayout& layout, const Vector& decays = Vector());

// Returns the residuals of the measured modes of `problem`, which must be
// valid. Returns nullptr if there are no modes. `layout` must outlive the
// result.
std::unique_ptr<ceres::CostFunction> MakeModalCost(
    const IdentificationProblem& problem, const ParameterLayout& layout);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_TRAJECTORY_COST_H_
