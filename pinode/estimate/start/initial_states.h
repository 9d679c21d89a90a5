// Initial states of a fit, estimated from the records before the
// identification.

#ifndef PINODE_ESTIMATE_START_INITIAL_STATES_H_
#define PINODE_ESTIMATE_START_INITIAL_STATES_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/trajectory_outline.h"

namespace pinode {

// Returns the circular frequencies of the initial linear model, ascending,
// without zeros.
std::vector<double> ModelFrequencies(const IdentificationProblem& problem);

// Returns a first guess of the states' scales (num_states) from a record's
// channels and the model's lowest frequency.
Vector GuessStateScales(const IdentificationProblem& problem,
                        const IdentificationRecord& record);

// Returns the RMS of each state over a trajectory (num_states x samples), at
// least a thousandth of the largest of its kind (displacements, velocities,
// internal).
Vector StateScales(const IdentificationProblem& problem, const Matrix& states);
// Returns the same from the states' mean squares.
Vector StateScalesOf(const IdentificationProblem& problem,
                     const Vector& mean_squares);

// Estimates trajectories of every training record by the iterated
// Rauch-Tung-Striebel smoother inside `shooting` (whose sigmas are set). It
// uses the model with the parameters `free` and segments of `segment_samples`
// joined softly; accelerations alone suffice. Returns false if no finite
// trajectory is found.
//
// `known`: a start for each training record, or empty. Over whole records (0
// segment samples) the starts are sought from there and from rest, and the
// better ones kept: from rest alone a nonlinear free decay may end in another
// minimum.
[[nodiscard]] bool InitialTrajectories(
    const IdentificationProblem& problem, Eigen::Index segment_samples,
    const Vector& free, const StageTuning& tuning, MultipleShooting* shooting,
    TrajectoryOutlines* trajectories, const std::vector<Vector>& known = {});

}  // namespace pinode

#endif  // PINODE_ESTIMATE_START_INITIAL_STATES_H_
