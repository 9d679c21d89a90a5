#include "pinode/problem/record_grid.h"

#include "pinode/integrate/exponential_step.h"

namespace pinode {

Integrator IntegratorOf(const StructuralDynamics& dynamics,
                        const IdentificationRecord& record) {
  if (record.integrator.value_or(record.substeps_chosen
                                     ? Integrator::kExact
                                     : Integrator::kRungeKutta) ==
      Integrator::kRungeKutta) {
    return Integrator::kRungeKutta;
  }
  if (dynamics.IsLinear()) return Integrator::kExact;
  return record.exponential_steps > 0 && ExponentialStep::Suits(dynamics)
             ? Integrator::kExponential
             : Integrator::kRungeKutta;
}

IntegrationGrid GridOf(const StructuralDynamics& dynamics,
                       const IdentificationRecord& record,
                       const Excitation& excitation) {
  switch (IntegratorOf(dynamics, record)) {
    case Integrator::kExact:
      return IntegrationGrid::Exact(excitation);
    case Integrator::kExponential:
      return IntegrationGrid(excitation, record.exponential_steps,
                             Integrator::kExponential);
    case Integrator::kRungeKutta:
      break;
  }
  return IntegrationGrid(excitation, record.substeps);
}

IntegrationGrid GridOf(const StructuralDynamics& dynamics,
                       const IdentificationRecord& record) {
  return GridOf(dynamics, record, *record.excitation);
}

}  // namespace pinode
