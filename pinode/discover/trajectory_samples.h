// States, rates and inputs along records, and values of features there.

#ifndef PINODE_DISCOVER_TRAJECTORY_SAMPLES_H_
#define PINODE_DISCOVER_TRAJECTORY_SAMPLES_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/feature.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// States h along the training records, one after the other, in SI units (or
// those of the model).
struct TrajectorySamples {
  Matrix states;  // num_states x samples
  Matrix rates;   // dh/dt
  Matrix inputs;  // num_inputs x samples
  Vector times;   // s
  std::vector<Eigen::Index> record_starts;
  std::vector<int> strides;  // samples here per sample of the record

  Eigen::Index num_samples() const { return times.size(); }
};

// Samples the simulations of the training records at every Runge-Kutta step,
// from model.starts (if they have the right size, else from FreeRunStart).
// Returns false if a run is not finite; *error names the record and the time.
[[nodiscard]] bool SampleTrajectories(const IdentificationProblem& problem,
                                      const IdentifiedModel& model,
                                      TrajectorySamples* samples,
                                      std::string* error);

// Returns the values of `features`, samples x features. The states begin with
// the displacements of the DOFs, followed by as many velocities.
Matrix FeatureValues(const std::vector<Feature>& features, int num_dofs,
                     const TrajectorySamples& samples);

}  // namespace pinode

#endif  // PINODE_DISCOVER_TRAJECTORY_SAMPLES_H_
