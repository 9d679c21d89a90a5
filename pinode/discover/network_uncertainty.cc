#include "pinode/discover/network_uncertainty.h"

#include <memory>
#include <utility>

#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/start/initial_states.h"
#include "pinode/network/network.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

// Samples of the records among those of every Runge-Kutta step.
struct RecordNodes {
  std::vector<Eigen::Index> columns;  // in the samples
  std::vector<Matrix> trajectories;   // num_states x samples, a training record
};

RecordNodes NodesOf(const TrajectorySamples& samples) {
  RecordNodes nodes;
  for (size_t t = 0; t < samples.record_starts.size(); ++t) {
    const Eigen::Index begin = samples.record_starts[t];
    const Eigen::Index end = t + 1 < samples.record_starts.size()
                                 ? samples.record_starts[t + 1]
                                 : samples.num_samples();
    Matrix trajectory(samples.states.rows(),
                      (end - 1 - begin) / samples.strides[t] + 1);
    for (Eigen::Index i = 0; i < trajectory.cols(); ++i) {
      nodes.columns.push_back(begin + i * samples.strides[t]);
      trajectory.col(i) = samples.states.col(nodes.columns.back());
    }
    nodes.trajectories.push_back(std::move(trajectory));
  }
  return nodes;
}

// Returns the noise levels of the training records; false if the model has
// none.
bool NoiseLevels(const IdentificationProblem& problem,
                 const IdentifiedModel& model, std::vector<Vector>* sigmas) {
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    if (record.channels.empty() || r >= model.sigmas.size() ||
        model.sigmas[r].size() !=
            static_cast<Eigen::Index>(record.channels.size()) ||
        !(model.sigmas[r].minCoeff() > 0.0)) {
      return false;
    }
    sigmas->push_back(model.sigmas[r]);
  }
  return true;
}

// Information matrix H = D L L' D of the free parameters.
struct Information {
  Vector scale;  // the diagonal of D
  Matrix lower;
};

// Computes the information; false if the model has no noise levels, or H is not
// finite.
bool InformationAt(const IdentificationProblem& problem,
                   const IdentifiedModel& model, const ParameterLayout& layout,
                   const std::vector<Matrix>& trajectories,
                   Information* information) {
  std::vector<Vector> sigmas;
  if (!NoiseLevels(problem, model, &sigmas)) return false;
  if (model.decays.size() != layout.num_decay_groups()) return false;
  std::vector<Vector> scales;
  for (const Matrix& trajectory : trajectories) {
    scales.push_back(StateScales(problem, trajectory));
  }
  Objective objective(problem, layout, MultipleShooting::Options());
  objective.shooting().SetSigmas(sigmas);
  objective.shooting().SetStateScales(scales);
  SetSegments(0, trajectories, &objective.shooting());
  objective.priors().SetDecays(model.decays);
  CondensedSystem system;
  if (!objective.Linearize(layout.Free(model.parameters), &system) ||
      !system.hessian.allFinite()) {
    return false;
  }
  // Undetermined directions would produce any uncertainty, also if the output
  // does not change along them.
  information->scale = system.hessian.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Vector& scale = information->scale;
  const Matrix hessian = scale.cwiseInverse().asDiagonal() * system.hessian *
                         scale.cwiseInverse().asDiagonal();
  return FactorizeInformation(hessian, &information->lower);
}

// Returns the standard deviations of the outputs of network j at the samples in
// `columns`.
Matrix OutputSigma(const IdentificationProblem& problem,
                   const IdentifiedModel& model, const ParameterLayout& layout,
                   const Information& information,
                   const TrajectorySamples& samples,
                   const std::vector<Eigen::Index>& columns, size_t j) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  const NetworkTerm& term = dynamics.networks()[j];
  const Matrix features =
      FeatureValues(term.features, dynamics.num_dofs(), samples);
  const int offset =
      dynamics.block_offset(dynamics.network_block(static_cast<int>(j)));
  NetworkTangent tangent(*term.network);
  Matrix sigma(term.outputs.cols(), static_cast<Eigen::Index>(columns.size()));
  for (size_t i = 0; i < columns.size(); ++i) {
    const Vector in = features.row(columns[i]).transpose();
    term.network->Linearize(in.data(), model.parameters.data() + offset,
                            &tangent);
    const Matrix weights = term.network->WeightJacobian(tangent);
    Matrix jacobian = Matrix::Zero(layout.num_free(), term.outputs.cols());
    for (Eigen::Index w = 0; w < weights.cols(); ++w) {
      const int k = layout.FreeIndex(offset + static_cast<int>(w));
      if (k >= 0) {
        jacobian.row(k) = weights.col(w).transpose() / information.scale[k];
      }
    }
    sigma.col(static_cast<Eigen::Index>(i)) =
        information.lower.triangularView<Eigen::Lower>()
            .solve(jacobian)
            .colwise()
            .norm()
            .transpose();
  }
  return sigma;
}

}  // namespace

std::vector<Matrix> NetworkUncertainty(const IdentificationProblem& problem,
                                       const IdentifiedModel& model,
                                       const TrajectorySamples& samples) {
  const RecordNodes nodes = NodesOf(samples);
  const ParameterLayout layout(problem);
  Information information;
  const bool known =
      InformationAt(problem, model, layout, nodes.trajectories, &information);
  const auto networks = problem.dynamics->networks();
  std::vector<Matrix> result;
  for (size_t j = 0; j < networks.size(); ++j) {
    result.push_back(known ? OutputSigma(problem, model, layout, information,
                                         samples, nodes.columns, j)
                           : Matrix(Matrix::Zero(networks[j].outputs.cols(),
                                                 static_cast<Eigen::Index>(
                                                     nodes.columns.size()))));
  }
  return result;
}

}  // namespace pinode
