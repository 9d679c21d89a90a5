// What the networks of a model stand for, along samples of the records.

#ifndef PINODE_DISCOVER_NETWORK_OUTPUTS_H_
#define PINODE_DISCOVER_NETWORK_OUTPUTS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/trajectory_samples.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// All networks at common samples, each in its output's unit.
struct NetworkOutputs {
  TrajectorySamples samples;
  std::vector<Matrix> outputs;  // samples x outputs, of each network
  // RMS of the outputs' standard deviation, of each network one an output.
  std::vector<Vector> uncertainty;
  Matrix mass;  // of the model that they belong to, DOFs x DOFs
};

// What trained networks say along the free runs of the training records. False
// for a run that is not finite.
[[nodiscard]] bool OutputsOfTrainedNetworks(
    const IdentificationProblem& problem, const IdentifiedModel& model,
    NetworkOutputs* result, std::string* error);

// What networks would have to supply by the smoothed training records (Lai et
// al. (2021), eqs. (8) and (9)): with accelerations a of SmoothRecord and those
// of the model without networks, its parameters at their initial values,
//
//   a - a_model(h, u) = sum_j B_j y_j,
//
// B_j being the network's map to accelerations, solved by least squares for
// all y_j at once. Samples of which the records know little are left out
// (WellKnownSamples). *begin: what a refit may begin with, its noise levels and
// free starts those of the smoothed records. False for a DOF that the records
// do not show, and outputs that accelerations do not tell apart.
[[nodiscard]] bool OutputsFromRecords(const IdentificationProblem& problem,
                                      NetworkOutputs* result,
                                      IdentifiedModel* begin,
                                      std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_NETWORK_OUTPUTS_H_
