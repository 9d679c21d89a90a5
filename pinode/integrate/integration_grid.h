// A record's samples, the steps between them, and the inputs at every stage.

#ifndef PINODE_INTEGRATE_INTEGRATION_GRID_H_
#define PINODE_INTEGRATE_INTEGRATION_GRID_H_

#include <memory>

#include "pinode/base/types.h"
#include "pinode/integrate/integrator.h"
#include "pinode/record/excitation.h"

namespace pinode {

// Samples i = 0 ... num_samples - 1 at start_time + i * sampling_step, with
// `substeps` steps of equal length in every interval. The inputs are tabulated
// once: every integration of the record reads the same values. Copies share the
// tables. If the inputs are held or linear between two samples, their values
// for the exact solution are computed on request. The steps of the exact
// solution only define where its inputs are tabulated. A periodic excitation
// has one interval more, from the last sample to the first one of the next
// period.
class IntegrationGrid {
 public:
  IntegrationGrid() = default;

  // `excitation` has one row per input of the dynamics, in their order.
  IntegrationGrid(const Excitation& excitation, int substeps,
                  Integrator integrator = Integrator::kRungeKutta);
  // Returns a grid for the exact solution. The number of steps depends on the
  // polynomial through their nodes. It equals the interpolation if that is
  // held, linear or cubic, and is within 1e-6 of it if it is band-limited.
  static IntegrationGrid Exact(const Excitation& excitation);

  // Creates a grid without inputs.
  IntegrationGrid(double start_time, double sampling_step,
                  Eigen::Index num_samples, int substeps);

  Integrator integrator() const { return integrator_; }
  Eigen::Index num_samples() const { return num_samples_; }
  Eigen::Index num_intervals() const { return num_intervals_; }
  int substeps() const { return substeps_; }
  int num_inputs() const { return static_cast<int>(at_samples_->rows()); }
  double sampling_step() const { return sampling_step_; }
  double step() const { return sampling_step_ / substeps_; }
  double time(Eigen::Index sample) const {
    return start_time_ + static_cast<double>(sample) * sampling_step_;
  }
  double step_time(Eigen::Index interval, int substep) const {
    return time(interval) + substep * step();
  }

  // Returns the inputs (num_inputs values) that act from sample i on, i <=
  // num_intervals(): a held input has already jumped.
  const double* AtSample(Eigen::Index sample) const {
    return at_samples_->data() + sample * at_samples_->rows();
  }

  // Returns the inputs at the beginning (node 0), middle (1) and end (2) of one
  // step. At the end a held input has not jumped yet. Not available for the
  // exact solution.
  const double* AtNode(Eigen::Index interval, int substep, int node) const {
    const Eigen::Index column = (interval * substeps_ + substep) * 3 + node;
    return at_nodes_->data() + column * at_nodes_->rows();
  }

  // Returns the same at all nodes of `count` intervals, one column per
  // interval. Its rows list the steps, in each step the nodes, and at each node
  // the inputs.
  void GetNodes(Eigen::Index first_interval, Eigen::Index count,
                Matrix* nodes) const;

 private:
  Integrator integrator_ = Integrator::kRungeKutta;
  double start_time_ = 0.0;
  double sampling_step_ = 1.0;
  Eigen::Index num_samples_ = 0;
  Eigen::Index num_intervals_ = 0;
  int substeps_ = 1;
  // Inputs at the samples, inputs x (intervals + 1).
  std::shared_ptr<const Matrix> at_samples_ = std::make_shared<const Matrix>();
  // Inputs at the nodes, inputs x (3 * substeps * intervals). nullptr: samples
  // that are held, or joined by straight lines.
  std::shared_ptr<const Matrix> at_nodes_;
  bool held_ = false;
};

}  // namespace pinode

#endif  // PINODE_INTEGRATE_INTEGRATION_GRID_H_
