#include "pinode/estimate/certainty/force_bands.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

int FirstTrainRecord(const IdentificationProblem& problem) {
  const auto& records = problem.records;
  return static_cast<int>(
      std::find_if(records.begin(), records.end(),
                   [](const IdentificationRecord& record) {
                     return record.role == IdentificationRecord::Role::kTrain;
                   }) -
      records.begin());
}

// Returns the record in which an unknown force acts.
int RecordOf(const IdentificationProblem& problem,
             const UnknownForceTerm& term) {
  if (term.input < 0) return FirstTrainRecord(problem);
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (problem.records[r].excitation->samples()(term.input, 0) != 0.0) {
      return static_cast<int>(r);
    }
  }
  return FirstTrainRecord(problem);
}

// Value of a force of time alone, and its derivatives by the parameters from
// index `first` on.
struct ForceAt {
  double value = 0.0;
  int first = 0;
  Vector derivatives;
};

// Estimates one force. `covariance` of all free parameters; empty: unknown.
ForceEstimate EstimateForce(const std::string& name,
                            const IdentificationProblem& problem,
                            const ParameterLayout& layout, int record,
                            const Matrix& covariance, double quantile,
                            const std::function<ForceAt(double)>& force) {
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  ForceEstimate estimate;
  estimate.name = name;
  estimate.record = record;
  const Eigen::Index count = (data.num_samples() - 1) * data.substeps + 1;
  estimate.times.resize(count);
  estimate.value.resize(count);
  estimate.sigma = Vector::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    estimate.times[i] = data.excitation->time(0) + static_cast<double>(i) *
                                                       data.sampling_step() /
                                                       data.substeps;
    const ForceAt at = force(estimate.times[i]);
    estimate.value[i] = at.value;
    std::vector<int> indices;
    std::vector<double> slopes;
    for (int a = 0; a < at.derivatives.size(); ++a) {
      const int index = layout.FreeIndex(at.first + a);
      if (index < 0) continue;
      indices.push_back(index);
      slopes.push_back(at.derivatives[a]);
    }
    if (indices.empty()) continue;
    if (covariance.size() == 0) {
      estimate.sigma[i] = kInfinity;
      continue;
    }
    const Eigen::Map<const Vector> slope(slopes.data(),
                                         static_cast<int>(slopes.size()));
    const double variance = slope.dot(covariance(indices, indices) * slope);
    estimate.sigma[i] =
        std::isnan(variance) ? kInfinity : std::sqrt(std::max(0.0, variance));
  }
  estimate.lower95 = estimate.value - quantile * estimate.sigma;
  estimate.upper95 = estimate.value + quantile * estimate.sigma;
  return estimate;
}

}  // namespace

Vector BandDecays(const IdentificationProblem& problem,
                  const ParameterLayout& layout, const Vector& decays,
                  const ForceBandTuning& tuning) {
  Vector pooled = decays;
  int first = 0;
  for (const UnknownForceTerm& term : problem.dynamics->unknown_forces()) {
    if (term.prior.combinations.empty() ||
        !term.parameters.parameters[0].free) {
      continue;
    }
    while (layout.decay_groups()[static_cast<size_t>(first)].kind !=
           ParameterLayout::DecayGroup::Kind::kForce) {
      ++first;
    }
    const int groups = term.prior.num_groups();
    const auto* spline = dynamic_cast<const SplineForce*>(term.history.get());
    if (spline != nullptr && term.prior.ShareToBeChosen() == 1.0) {
      const double width = spline->options().spacing *
                           static_cast<double>(term.prior.combinations.size()) /
                           groups;
      const double step =
          problem.records[static_cast<size_t>(RecordOf(problem, term))]
              .sampling_step();
      const int reach = static_cast<int>(
          std::ceil(tuning.pooled_samples * step / width - 1e-9));
      for (int g = 0; g < groups; ++g) {
        const int from = std::max(0, g - reach);
        const int to = std::min(groups - 1, g + reach);
        pooled[first + g] = 1.0 / decays.segment(first + from, to - from + 1)
                                      .cwiseMax(1e-300)
                                      .cwiseInverse()
                                      .mean();
      }
    }
    first += groups;
  }
  return pooled;
}

std::vector<ForceEstimate> EstimateForces(const IdentificationProblem& problem,
                                          const ParameterLayout& layout,
                                          const Vector& parameters,
                                          const Matrix& covariance,
                                          double quantile) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  std::vector<ForceEstimate> forces;
  if (problem.num_train_records() == 0) return forces;
  for (size_t j = 0; j < dynamics.unknown_forces().size(); ++j) {
    const UnknownForceTerm& term = dynamics.unknown_forces()[j];
    const int offset = dynamics.block_offset(
        dynamics.unknown_force_block(static_cast<int>(j)));
    forces.push_back(EstimateForce(
        term.name, problem, layout, RecordOf(problem, term), covariance,
        quantile, [&](double time) {
          const ForceHistory::Local local =
              term.history->Evaluate(time, parameters.data() + offset);
          Vector derivatives(local.count);
          std::copy_n(local.derivatives, local.count, derivatives.data());
          return ForceAt{local.value, offset + local.first,
                         std::move(derivatives)};
        }));
  }
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const NetworkTerm& term = dynamics.networks()[j];
    if (!IsForceOfTime(term)) continue;
    const int offset =
        dynamics.block_offset(dynamics.network_block(static_cast<int>(j)));
    const Network& network = *term.network;
    NetworkTangent tangent(network);
    for (int o = 0; o < network.num_outputs(); ++o) {
      const std::string name = network.num_outputs() == 1
                                   ? term.name
                                   : term.name + "_" + std::to_string(o + 1);
      forces.push_back(EstimateForce(
          name, problem, layout, FirstTrainRecord(problem), covariance,
          quantile, [&](double time) {
            const Vector q = Vector::Constant(network.num_inputs(), time);
            network.Linearize(q.data(), parameters.data() + offset, &tangent);
            // A network resists; the force pushes.
            return ForceAt{-tangent.value()[o], offset,
                           -network.WeightJacobian(tangent).row(o)};
          }));
    }
  }
  return forces;
}

}  // namespace pinode
