#include "pinode/estimate/objective/bending.h"

#include <algorithm>
#include <cmath>

#include "pinode/dynamics/network_term.h"

namespace pinode {

bool HasNetworksOfState(const IdentificationProblem& problem,
                        const ParameterLayout& layout) {
  const auto& networks = problem.dynamics->networks();
  return layout.HasNetworkDecay() &&
         !std::all_of(networks.begin(), networks.end(), IsForceOfTime);
}

bool BendsSteps(const IdentificationProblem& problem,
                const ParameterLayout& layout) {
  for (int j = 0; j < layout.num_free(); ++j) {
    const Parameter& parameter = layout.free_parameter(j);
    if (std::isfinite(parameter.lower) || std::isfinite(parameter.upper)) {
      return false;
    }
  }
  return HasNetworksOfState(problem, layout);
}

BentCost::Bend BendOf(Objective* objective, const BoundedCost* bounded) {
  return [objective, bounded](const Vector& step, Vector* projected) {
    if (!objective->shooting().BendAlong(bounded->Unscaled(step), projected)) {
      return false;
    }
    *projected = bounded->Unscaled(*projected);
    return true;
  };
}

}  // namespace pinode
