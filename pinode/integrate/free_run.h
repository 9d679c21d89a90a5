// Plain integration over a record.

#ifndef PINODE_INTEGRATE_FREE_RUN_H_
#define PINODE_INTEGRATE_FREE_RUN_H_

#include <string>

#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integration_grid.h"

namespace pinode {

// What is kept of a run: everything; channels and the states' mean squares;
// channels alone. States are most of its memory, and where modes are summed
// most of its work.
enum class Keep { kAll, kMeanSquares, kChannels };

// States and channels at the samples [first, first + num_samples()).
struct Trajectory {
  Eigen::Index first_sample = 0;
  Matrix states;    // num_states x samples, or the last one alone
  Matrix channels;  // num_channels x samples
  // Of the states, where these are not kept: over the samples, of a linear run
  // of more than 32768 over every second, third, ... of them.
  Vector mean_squares;
  // Where a state stopped being finite: sample and index of the state; -1 if
  // nowhere.
  Eigen::Index failed_sample = -1;
  int failed_state = -1;

  bool IsFinite() const { return failed_sample < 0; }
  Eigen::Index num_samples() const { return channels.cols(); }
};

// Integrates from `start` (num_states) at first_sample to last_sample, both
// included and at most grid.num_intervals(). A state beyond 1e100 counts as not
// finite. Returns trajectory->IsFinite(); the samples from the failure on are
// NaN. A run that fails keeps all. Threads share what goes by modes; how many
// does not change a bit.
bool FreeRun(const StructuralDynamics& dynamics,
             const StructuralDynamics::Prepared& prepared,
             const ObservationMap& observation, const IntegrationGrid& grid,
             const Vector& start, Eigen::Index first_sample,
             Eigen::Index last_sample, Trajectory* trajectory,
             Keep keep = Keep::kAll, int num_threads = 1);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_FREE_RUN_H_
