// Outputs of a model's networks along samples of the records.

#ifndef PINODE_DISCOVER_NETWORK_OUTPUTS_H_
#define PINODE_DISCOVER_NETWORK_OUTPUTS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/trajectory_samples.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Outputs of all networks at common samples, each in its own unit.
struct NetworkOutputs {
  TrajectorySamples samples;
  std::vector<Matrix> outputs;  // samples x outputs, per network
  // RMS of the outputs' standard deviation: per network, one value per output.
  std::vector<Vector> uncertainty;
  Matrix mass;  // of their model, DOFs x DOFs
};

// Computes the outputs of trained networks along the simulations of the
// training records. Returns false for a run that is not finite.
[[nodiscard]] bool OutputsOfTrainedNetworks(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    NetworkOutputs* result, std::string* error);

// Computes the outputs that networks must supply to match the smoothed training
// records (Lai et al. (2021), eqs. (8) and (9)). With accelerations a of
// SmoothRecord and those of the model without networks, its parameters at their
// initial values,
//
//   a - a_model(h, u) = sum_j B_j y_j,
//
// where B_j is the network's map to accelerations, solved by least squares for
// all y_j at once. Samples with a large uncertainty are left out
// (WellKnownSamples). *begin: initial model of a refit, with noise levels and
// free starts of the smoothed records. Returns false for a DOF that the records
// do not determine, and for outputs that accelerations do not distinguish.
[[nodiscard]] bool OutputsFromRecords(const IdentificationProblem& problem,
                                      NetworkOutputs* result,
                                      IdentifiedModel* begin,
                                      std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_NETWORK_OUTPUTS_H_
