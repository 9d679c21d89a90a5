#include "pinode/integrate/integration_grid.h"

#include <utility>

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
                                 Eigen::Index num_samples, int substeps)
    : start_time_(start_time),
      sampling_step_(sampling_step),
      num_samples_(num_samples),
      num_intervals_(num_samples - 1),
      substeps_(substeps),
      at_samples_(std::make_shared<const Matrix>(0, num_samples)),
      at_nodes_(
          std::make_shared<const Matrix>(0, 3 * substeps * (num_samples - 1))) {
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
  // Without inputs there is nothing to look up.
  const Eigen::Index looked_up =
      excitation.num_inputs() > 0 ? num_intervals_ : 0;
  if (!excitation.periodic()) {
    at_samples_ = excitation.shared_samples();
  } else {
    Matrix at_samples(excitation.num_inputs(), num_intervals_ + 1);
    for (Eigen::Index i = 0; i <= looked_up; ++i) {
      excitation.Evaluate(i, 0.0, at_samples.col(i).data());
    }
    at_samples_ = std::make_shared<const Matrix>(std::move(at_samples));
  }
  held_ = excitation.interpolation() == Interpolation::kHeld;
  at_nodes_ = nullptr;
  if (integrator == Integrator::kExact && substeps == 1 &&
      (held_ || excitation.interpolation() == Interpolation::kLinear)) {
    return;
  }
  Matrix at_nodes(excitation.num_inputs(), 3 * substeps * num_intervals_);
  // One fraction of an interval after the other: see SincWeightsAt of
  // excitation.cc.
  for (int s = 0; s < substeps; ++s) {
    for (int node = 0; node < 3; ++node) {
      const double fraction = (s + 0.5 * node) / substeps;
      for (Eigen::Index i = 0; i < looked_up; ++i) {
        const Eigen::Index column = (i * substeps + s) * 3 + node;
        excitation.Evaluate(i, fraction, at_nodes.col(column).data());
      }
    }
  }
  at_nodes_ = std::make_shared<const Matrix>(std::move(at_nodes));
}

void IntegrationGrid::GetNodes(Eigen::Index first_interval, Eigen::Index count,
                               Matrix* nodes) const {
  const Eigen::Index inputs = num_inputs();
  const Eigen::Index rows = 3 * substeps_ * inputs;
  if (at_nodes_ != nullptr) {
    *nodes = Eigen::Map<const Matrix>(at_nodes_->data() + first_interval * rows,
                                      rows, count);
    return;
  }
  nodes->resize(rows, count);
  const auto left = at_samples_->middleCols(first_interval, count);
  nodes->topRows(inputs) = left;
  if (held_) {
    nodes->middleRows(inputs, inputs) = left;
    nodes->bottomRows(inputs) = left;
    return;
  }
  const auto right = at_samples_->middleCols(first_interval + 1, count);
  nodes->middleRows(inputs, inputs) = 0.5 * left + 0.5 * right;
  nodes->bottomRows(inputs) = right;
}

}  // namespace pinode
