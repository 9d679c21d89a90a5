#include "pinode/estimate/record_grid.h"

namespace pinode {

Integrator IntegratorOf(const StructuralDynamics& dynamics,
                        const IdentificationRecord& record) {
  const bool exact = record.integrator.value_or(
                         record.substeps_chosen
                             ? Integrator::kExact
                             : Integrator::kRungeKutta) == Integrator::kExact;
  return exact && dynamics.IsLinear() ? Integrator::kExact
                                      : Integrator::kRungeKutta;
}

IntegrationGrid GridOf(const StructuralDynamics& dynamics,
                       const IdentificationRecord& record,
                       const Excitation& excitation) {
  return IntegratorOf(dynamics, record) == Integrator::kExact
             ? IntegrationGrid::Exact(excitation)
             : IntegrationGrid(excitation, record.substeps);
}

IntegrationGrid GridOf(const StructuralDynamics& dynamics,
                       const IdentificationRecord& record) {
  return GridOf(dynamics, record, *record.excitation);
}

}  // namespace pinode
