// Total cost that a fit minimises.

#ifndef PINODE_ESTIMATE_OBJECTIVE_OBJECTIVE_H_
#define PINODE_ESTIMATE_OBJECTIVE_OBJECTIVE_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/estimate/frf/frf_cost.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/estimate/objective/prior_cost.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {

// Returns the shooting options of an identification.
MultipleShooting::Options ShootingOptions(const IdentificationOptions& options);

// Sum of a problem's trajectories, priors, measured modes, ambient records and
// frequency response functions.
// Each part is set separately: noise levels and segments in shooting(), decays
// in priors().
class Objective final : public CostPart {
 public:
  // Keeps references to `problem` (valid) and `layout`, which must outlive this
  // object.
  Objective(const IdentificationProblem& problem, const ParameterLayout& layout,
            const MultipleShooting::Options& options);

  MultipleShooting& shooting() { return shooting_; }
  const MultipleShooting& shooting() const { return shooting_; }
  PriorCost& priors() { return priors_; }
  // Cost of the measured modes; nullptr: no mode was measured.
  ModalCost* modes() const { return modes_.get(); }
  // Costs of the ambient records, one each.
  const std::vector<std::unique_ptr<AmbientCost>>& ambient() const {
    return ambient_;
  }
  // Costs of the frequency response functions, one each.
  const std::vector<std::unique_ptr<FrfCost>>& frfs() const { return frfs_; }

  [[nodiscard]] bool Evaluate(const Vector& free, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& free,
                               CondensedSystem* system) override;
  // Failure of the first part that has failed.
  std::string Failure() const override;

  // Hessian of modes, ambient records and FRFs at the last Linearize, num_free
  // x num_free; empty without any.
  const Matrix& other_information() const { return other_information_; }

 private:
  MultipleShooting shooting_;
  PriorCost priors_;
  std::unique_ptr<ModalCost> modes_;
  std::vector<std::unique_ptr<AmbientCost>> ambient_;
  std::vector<std::unique_ptr<FrfCost>> frfs_;
  std::vector<CostPart*> spectra_;  // ambient_ and frfs_
  Matrix other_information_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_OBJECTIVE_OBJECTIVE_H_
