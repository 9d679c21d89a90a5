// The motion of all DOFs over one record, without a model of the structure.

#ifndef PINODE_DISCOVER_SMOOTHED_RECORD_H_
#define PINODE_DISCOVER_SMOOTHED_RECORD_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

struct SmoothedRecord {
  // States (displacements and velocities) and their rates: 2 DOFs x samples.
  Matrix states;
  Matrix rates;
  // Standard deviations of the accelerations, DOFs x samples.
  Matrix sigma;
  // Noise level of each channel of the record, in its unit.
  Vector noise;
};

// Smooths each DOF (SmoothMotion) from the fitted channels that measure it
// alone; absolute accelerations and displacements are used less the ground's
// own. Channels of several DOFs, or that are not fitted, take no part. Their
// noise is as given, or 5 % of their spread. Returns false for a DOF without a
// displacement channel of its own; *error names the record and the DOF.
[[nodiscard]] bool SmoothRecord(const IdentificationProblem& problem,
                                const IdentificationRecord& record,
                                SmoothedRecord* result, std::string* error);

// Returns the samples (columns of `sigma`) at which no DOF's standard deviation
// exceeds twice its median. This excludes the ends of a record, where a
// smoother is uncertain.
std::vector<Eigen::Index> WellKnownSamples(const Matrix& sigma);

}  // namespace pinode

#endif  // PINODE_DISCOVER_SMOOTHED_RECORD_H_
