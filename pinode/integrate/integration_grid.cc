#include "pinode/integrate/integration_grid.h"

#include "pinode/base/logging.h"

namespace pinode {

const char* IntegratorName(Integrator integrator) {
  switch (integrator) {
    case Integrator::kExact:
      return "exact";
    case Integrator::kExponential:
      return "exponential";
    case Integrator::kRungeKutta:
      break;
  }
  return "rk4";
}

IntegrationGrid::IntegrationGrid(double start_time, double sampling_step,
                                 int num_samples, int substeps)
    : start_time_(start_time),
      sampling_step_(sampling_step),
      num_samples_(num_samples),
      num_intervals_(num_samples - 1),
      substeps_(substeps),
      at_samples_(0, num_samples),
      at_nodes_(0, 3 * substeps * (num_samples - 1)) {
  CHECK_GE(num_samples, 2) << "a record needs at least two samples";
  CHECK_GE(substeps, 1);
  CHECK_GT(sampling_step, 0.0);
}

IntegrationGrid IntegrationGrid::Exact(const Excitation& excitation) {
  int steps = 1;
  switch (excitation.interpolation()) {
    case Interpolation::kHeld:
    case Interpolation::kLinear:
      steps = 1;
      break;
    case Interpolation::kCubic:
      steps = 2;
      break;
    case Interpolation::kBandLimited:
      steps = 4;
      break;
  }
  return IntegrationGrid(excitation, steps, Integrator::kExact);
}

IntegrationGrid::IntegrationGrid(const Excitation& excitation, int substeps,
                                 Integrator integrator)
    : IntegrationGrid(excitation.time(0), excitation.step(),
                      excitation.num_samples(), substeps) {
  integrator_ = integrator;
  if (excitation.periodic()) num_intervals_ = num_samples_;
  at_samples_.resize(excitation.num_inputs(), num_intervals_ + 1);
  at_nodes_.resize(excitation.num_inputs(), 3 * substeps * num_intervals_);
  for (int i = 0; i <= num_intervals_; ++i) {
    excitation.Evaluate(i, 0.0, at_samples_.col(i).data());
  }
  // One fraction of an interval after the other: see SincWeightsAt of
  // excitation.cc.
  for (int s = 0; s < substeps; ++s) {
    for (int node = 0; node < 3; ++node) {
      const double fraction = (s + 0.5 * node) / substeps;
      for (int i = 0; i < num_intervals_; ++i) {
        excitation.Evaluate(
            i, fraction, at_nodes_.col((i * substeps + s) * 3 + node).data());
      }
    }
  }
}

}  // namespace pinode
