// Integrates the dynamics over a record without corrections.

#ifndef PINODE_INTEGRATE_FREE_RUN_H_
#define PINODE_INTEGRATE_FREE_RUN_H_

#include <string>

#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"

namespace pinode {

// Stored results of a run: everything; channels and the states' mean squares;
// channels alone. The states need most of the memory, and most of the work if
// modes are summed.
enum class Keep { kAll, kMeanSquares, kChannels };

// States and channels at the samples [first, first + num_samples()).
struct Trajectory {
  Eigen::Index first_sample = 0;
  Matrix states;    // num_states x samples, or the last one alone
  Matrix channels;  // num_channels x samples
  // Mean squares of the states over the samples, if the states are not stored.
  // A linear run of more than 32768 samples uses every second, third, ...
  // sample.
  Vector mean_squares;
  // Sample and index of the first state that was not finite; -1 if all are
  // finite.
  Eigen::Index failed_sample = -1;
  int failed_state = -1;

  bool IsFinite() const { return failed_sample < 0; }
  Eigen::Index num_samples() const { return channels.cols(); }
};

// Integrates from `start` (num_states) at first_sample to last_sample, both
// included and at most grid.num_intervals(). A state beyond 1e100 counts as not
// finite. Returns trajectory->IsFinite(). The samples from the failure on are
// NaN. A run that fails stores everything. Threads share the work on modes. The
// results are the same, bit for bit, for any number of threads.
bool FreeRun(const StructuralDynamics& dynamics,
             const StructuralDynamics::Prepared& prepared,
             const ObservationMap& observation, const IntegrationGrid& grid,
             const Vector& start, Eigen::Index first_sample,
             Eigen::Index last_sample, Trajectory* trajectory,
             Keep keep = Keep::kAll, int num_threads = 1);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_FREE_RUN_H_
