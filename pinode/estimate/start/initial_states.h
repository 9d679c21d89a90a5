// Where a fit begins: states from the records before anything is identified.

#ifndef PINODE_ESTIMATE_START_INITIAL_STATES_H_
#define PINODE_ESTIMATE_START_INITIAL_STATES_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/trajectory_outline.h"

namespace pinode {

// Circular frequencies of the linear model before the identification,
// ascending, without zeros.
std::vector<double> ModelFrequencies(const IdentificationProblem& problem);

// First guess of the states' scales (num_states) from what a record's channels
// show and the model's lowest frequency.
Vector GuessStateScales(const IdentificationProblem& problem,
                        const IdentificationRecord& record);

// RMS of each state over a trajectory (num_states x samples), never below a
// thousandth of the largest of its kind (displacements, velocities, internal).
Vector StateScales(const IdentificationProblem& problem, const Matrix& states);
// The same from the states' mean squares.
Vector StateScalesOf(const IdentificationProblem& problem,
                     const Vector& mean_squares);

// Trajectories of every training record by the iterated
// Rauch-Tung-Striebel smoother inside `shooting` (whose sigmas are set), on the
// model with the parameters `free` and segments of `segment_samples` joined
// softly: accelerations alone suffice. False where no finite trajectory is
// found.
[[nodiscard]] bool InitialTrajectories(const IdentificationProblem& problem,
                                       Eigen::Index segment_samples,
                                       const Vector& free,
                                       const StageTuning& tuning,
                                       MultipleShooting* shooting,
                                       TrajectoryOutlines* trajectories);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_INITIAL_STATES_H_
