#include "pinode/discover/network_outputs.h"

#include <Eigen/QR>
#include <memory>
#include <utility>

#include "pinode/base/statistics.h"
#include "pinode/discover/network_uncertainty.h"
#include "pinode/discover/smoothed_record.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/network/network.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

// Evaluates network j along the samples, samples x outputs.
Matrix EvaluateNetwork(const StructuralDynamics& dynamics, size_t j,
                       const Vector& parameters,
                       const TrajectorySamples& samples) {
  const NetworkTerm& term = dynamics.networks()[j];
  const double* weights =
      parameters.data() +
      dynamics.block_offset(dynamics.network_block(static_cast<int>(j)));
  const Matrix inputs =
      FeatureValues(term.features, dynamics.num_dofs(), samples);
  Matrix outputs(samples.num_samples(), term.outputs.cols());
  NetworkWorkspace workspace(*term.network);
  Vector in(inputs.cols());
  Vector out(term.outputs.cols());
  for (Eigen::Index i = 0; i < samples.num_samples(); ++i) {
    in = inputs.row(i).transpose();
    term.network->Evaluate(in.data(), weights, out.data(), &workspace);
    outputs.row(i) = out.transpose();
  }
  return outputs;
}

// Prepares the model without networks: they are 0 if all their weights are.
bool PrepareWithoutNetworks(const StructuralDynamics& dynamics,
                            const Vector& parameters,
                            StructuralDynamics::Prepared* prepared,
                            std::string* error) {
  Vector theta = parameters.head(dynamics.num_parameters());
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const int block = dynamics.network_block(static_cast<int>(j));
    theta
        .segment(dynamics.block_offset(block),
                 dynamics.networks()[j].network->num_weights())
        .setZero();
  }
  return dynamics.Prepare(theta, prepared, error);
}

Vector StartOf(const IdentificationRecord& record,
               const SmoothedRecord& smoothed) {
  switch (record.start) {
    case IdentificationRecord::Start::kKnown:
      return record.known_start;
    case IdentificationRecord::Start::kRest:
      return Vector::Zero(smoothed.states.rows());
    case IdentificationRecord::Start::kFree:
      break;
  }
  return smoothed.states.col(0);
}

void AppendColumns(const Matrix& more, Matrix* all) {
  const Eigen::Index before = all->cols();
  all->conservativeResize(more.rows(), before + more.cols());
  all->rightCols(more.cols()) = more;
}

// Differences between accelerations of smoothed records and those of a model.
class MissingAccelerations {
 public:
  MissingAccelerations(const StructuralDynamics& dynamics,
                       const StructuralDynamics::Prepared& prepared)
      : dynamics_(dynamics),
        prepared_(prepared),
        values_(dynamics.num_dofs(), 0),
        variance_(dynamics.num_dofs(), 0) {}

  void Add(const IdentificationRecord& record, const SmoothedRecord& smoothed) {
    const int n = dynamics_.num_dofs();
    const std::vector<Eigen::Index> kept = WellKnownSamples(smoothed.sigma);
    const Eigen::Index count = static_cast<Eigen::Index>(kept.size());
    const Matrix states = smoothed.states(Eigen::all, kept);
    const Matrix rates = smoothed.rates(Eigen::all, kept);
    const Matrix inputs = record.excitation->samples()(Eigen::all, kept);
    Matrix missing(n, count);
    Vector times(count);
    Vector model_rate(2 * n);
    auto stage = dynamics_.MakeLinearization();
    for (Eigen::Index k = 0; k < count; ++k) {
      times[k] = record.excitation->time(kept[static_cast<size_t>(k)]);
      dynamics_.Rate(prepared_, times[k], inputs.col(k).data(),
                     states.col(k).data(), model_rate.data(), &stage);
      missing.col(k) = rates.col(k).tail(n) - model_rate.tail(n);
    }
    samples_.record_starts.push_back(samples_.num_samples());
    samples_.strides.push_back(1);
    samples_.times.conservativeResize(samples_.times.size() + count);
    samples_.times.tail(count) = times;
    AppendColumns(states, &samples_.states);
    AppendColumns(rates, &samples_.rates);
    AppendColumns(inputs, &samples_.inputs);
    AppendColumns(missing, &values_);
    AppendColumns(smoothed.sigma(Eigen::all, kept).array().square().matrix(),
                  &variance_);
  }

  const TrajectorySamples& samples() const { return samples_; }
  const Matrix& values() const { return values_; }      // DOFs x samples
  const Matrix& variance() const { return variance_; }  // DOFs x samples

 private:
  const StructuralDynamics& dynamics_;
  const StructuralDynamics::Prepared& prepared_;
  TrajectorySamples samples_;
  Matrix values_;
  Matrix variance_;
};

// Solves missing = sum_j B_j y_j for y, by least squares.
bool SolveForOutputs(const StructuralDynamics& dynamics,
                     const StructuralDynamics::Prepared& prepared,
                     const MissingAccelerations& missing,
                     NetworkOutputs* result, std::string* error) {
  const int n = dynamics.num_dofs();
  Matrix map(n, 0);
  std::vector<Eigen::Index> counts;
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const Matrix part = dynamics.NetworkMap(prepared, static_cast<int>(j));
    counts.push_back(part.cols());
    AppendColumns(part, &map);
  }
  const Eigen::ColPivHouseholderQR<Matrix> qr(map);
  if (qr.rank() < map.cols()) {
    *error = "the networks have " + std::to_string(map.cols()) +
             " outputs, but accelerations determine only " +
             std::to_string(qr.rank()) +
             ", expected not more with source = \"derivatives\"";
    return false;
  }
  const Matrix inverse = qr.solve(Matrix::Identity(n, n));
  const Matrix outputs = (inverse * missing.values()).transpose();
  const Vector variance =
      inverse.array().square().matrix() * missing.variance().rowwise().mean();
  Eigen::Index first = 0;
  for (const Eigen::Index count : counts) {
    result->outputs.push_back(outputs.middleCols(first, count));
    result->uncertainty.push_back(variance.segment(first, count).cwiseSqrt());
    first += count;
  }
  return true;
}

}  // namespace

bool OutputsOfTrainedNetworks(const IdentificationProblem& problem,
                              const IdentifiedModel& model,
                              NetworkOutputs* result, std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  NetworkOutputs found;
  if (!SampleTrajectories(problem, model, &found.samples, error)) return false;
  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(model.parameters.head(dynamics.num_parameters()),
                        &prepared, error)) {
    return false;
  }
  found.mass = prepared.linear.mass;
  for (const Matrix& sigma :
       NetworkUncertainty(problem, model, found.samples)) {
    Vector uncertainty(sigma.rows());
    for (Eigen::Index o = 0; o < sigma.rows(); ++o) {
      uncertainty[o] = RmsOfPresent(sigma.row(o).transpose());
    }
    found.uncertainty.push_back(std::move(uncertainty));
  }
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    found.outputs.push_back(
        EvaluateNetwork(dynamics, j, model.parameters, found.samples));
  }
  *result = std::move(found);
  return true;
}

bool OutputsFromRecords(const IdentificationProblem& problem,
                        NetworkOutputs* result, IdentifiedModel* begin,
                        std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  IdentifiedModel model;
  model.parameters = ParameterLayout(problem).InitialValues();
  model.sigmas.resize(problem.records.size());
  model.starts.resize(problem.records.size());
  StructuralDynamics::Prepared prepared;
  if (!PrepareWithoutNetworks(dynamics, model.parameters, &prepared, error)) {
    return false;
  }
  MissingAccelerations missing(dynamics, prepared);
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    SmoothedRecord smoothed;
    if (!SmoothRecord(problem, record, &smoothed, error)) return false;
    missing.Add(record, smoothed);
    model.sigmas[r] = smoothed.noise;
    model.starts[r] = StartOf(record, smoothed);
  }
  NetworkOutputs found;
  if (!SolveForOutputs(dynamics, prepared, missing, &found, error)) {
    return false;
  }
  found.samples = missing.samples();
  found.mass = prepared.linear.mass;
  *result = std::move(found);
  *begin = std::move(model);
  return true;
}

}  // namespace pinode
