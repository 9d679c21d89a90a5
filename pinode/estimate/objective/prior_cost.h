// Prior knowledge of the free parameters.

#ifndef PINODE_ESTIMATE_OBJECTIVE_PRIOR_COST_H_
#define PINODE_ESTIMATE_OBJECTIVE_PRIOR_COST_H_

#include <ceres/cost_function.h>

#include <string>

#include "pinode/base/types.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Gaussian priors of single parameters and of combinations that decay,
//
//   1/2 sum_j (theta_j - mean_j)^2 / tau_j^2
//     + 1/2 sum over decay rows of alpha_group (weights' theta)^2,
//
// one residual each, linear in the free parameters, which are the single
// parameter block.
class PriorCost final : public ceres::CostFunction, public CostPart {
 public:
  // Starts without decay: every alpha is zero. Keeps a reference to `layout`,
  // which must outlive this object.
  explicit PriorCost(const ParameterLayout& layout);

  // Sets alpha, one per decay group of the layout, not negative.
  void SetDecays(const Vector& decays);

  // Number of priors. 0: there is no prior, and Ceres needs no such block.
  int num_priors() const { return num_residuals(); }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;
  [[nodiscard]] bool Evaluate(const Vector& free, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& free,
                               CondensedSystem* system) override;
  std::string Failure() const override { return ""; }

 private:
  const ParameterLayout& layout_;
  Vector decays_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_PRIOR_COST_H_
