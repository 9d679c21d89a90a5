// What is known of the free parameters before the data are seen.

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
// a residual each, linear in the free parameters, which are the one parameter
// block.
class PriorCost final : public ceres::CostFunction, public CostPart {
 public:
  // No decay: every alpha is zero. `layout` must outlive this object.
  explicit PriorCost(const ParameterLayout& layout);

  // alpha, one per decay group of the layout, not negative.
  void SetDecays(const Vector& decays);

  // 0 where there is no prior at all: Ceres then needs no such block.
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
