// The motion of all DOFs over one record, without a model of the structure.

#ifndef PINODE_DISCOVER_SMOOTHED_RECORD_H_
#define PINODE_DISCOVER_SMOOTHED_RECORD_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

struct SmoothedRecord {
  // Displacements and velocities, and their rates: 2 DOFs x samples.
  Matrix states;
  Matrix rates;
  // Standard deviations of the accelerations, DOFs x samples.
  Matrix sigma;
  // Noise level of each channel of the record, in its unit.
  Vector noise;
};

// Smooths each DOF (SmoothMotion) from the fitted channels that show it alone,
// absolute accelerations and displacements less the ground's own. Channels that
// show several DOFs, or are not fitted, take no part; their noise is as given,
// or 5 % of their spread. False for a DOF without a displacement channel of its
// own; *error names the record and the DOF.
[[nodiscard]] bool SmoothRecord(const IdentificationProblem& problem,
                                const IdentificationRecord& record,
                                SmoothedRecord* result, std::string* error);

// The samples (columns of `sigma`) at which no DOF's standard deviation is more
// than twice its median: not those at the ends of a record, where a smoother
// knows little.
std::vector<Eigen::Index> WellKnownSamples(const Matrix& sigma);

}  // namespace pinode

#endif  // PINODE_DISCOVER_SMOOTHED_RECORD_H_
