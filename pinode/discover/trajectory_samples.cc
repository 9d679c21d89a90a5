#include "pinode/discover/trajectory_samples.h"

#include <memory>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/start/free_run_start.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/rk4.h"

namespace pinode {
namespace {

Vector StartOfRun(const IdentificationProblem& problem,
                  const IdentifiedModel& model, size_t r) {
  if (r < model.starts.size() &&
      model.starts[r].size() == problem.dynamics->num_states()) {
    return model.starts[r];
  }
  const Vector sigmas = r < model.sigmas.size() && model.sigmas[r].size() > 0
                            ? model.sigmas[r]
                            : Vector(Vector::Ones(static_cast<Eigen::Index>(
                                  problem.records[r].channels.size())));
  Vector state;
  FreeRunStart(problem, static_cast<int>(r), model.parameters, sigmas, &state);
  return state;
}

// Runs records one after the other and stores the samples.
class Sampler {
 public:
  Sampler(const StructuralDynamics& dynamics,
          const StructuralDynamics::Prepared& prepared, Eigen::Index total)
      : dynamics_(dynamics),
        prepared_(prepared),
        stage_(dynamics.MakeLinearization()),
        scratch_(dynamics.num_states()) {
    samples_.states.resize(dynamics.num_states(), total);
    samples_.rates.resize(dynamics.num_states(), total);
    samples_.inputs.resize(dynamics.num_inputs(), total);
    samples_.times.resize(total);
  }

  bool Run(const IdentificationRecord& record, Vector state,
           std::string* error) {
    samples_.record_starts.push_back(column_);
    samples_.strides.push_back(record.substeps);
    const IntegrationGrid grid(*record.excitation, record.substeps);
    const Eigen::Index last = record.num_samples() - 1;
    const auto not_finite = [&](Eigen::Index i) {
      *error = "the simulation of record '" + record.name +
               "' with the identified model is not finite from t = " +
               FormatNumber(grid.time(i), 6) + " on";
      return false;
    };
    for (Eigen::Index i = 0; i < last; ++i) {
      for (int s = 0; s < grid.substeps(); ++s) {
        if (!state.allFinite()) return not_finite(i);
        const double time = grid.step_time(i, s);
        Add(time, s == 0 ? grid.AtSample(i) : grid.AtNode(i, s, 0), state);
        Rk4Step(
            [&](int node, double t, const double* h, double* rate) {
              dynamics_.Rate(prepared_, t, grid.AtNode(i, s, node), h, rate,
                             &stage_);
            },
            time, grid.step(), state.data(), &scratch_);
      }
    }
    if (!state.allFinite()) return not_finite(last);
    Add(grid.time(last), grid.AtSample(last), state);
    return true;
  }

  TrajectorySamples Take() {
    CHECK_EQ(column_, samples_.num_samples());
    return std::move(samples_);
  }

 private:
  void Add(double time, const double* input, const Vector& state) {
    samples_.times[column_] = time;
    samples_.states.col(column_) = state;
    samples_.inputs.col(column_) =
        Eigen::Map<const Vector>(input, dynamics_.num_inputs());
    dynamics_.Rate(prepared_, time, input, state.data(),
                   samples_.rates.col(column_).data(), &stage_);
    ++column_;
  }

  const StructuralDynamics& dynamics_;
  const StructuralDynamics::Prepared& prepared_;
  StructuralDynamics::Linearization stage_;
  Rk4Scratch<double> scratch_;
  TrajectorySamples samples_;
  Eigen::Index column_ = 0;
};

}  // namespace

bool SampleTrajectories(const IdentificationProblem& problem,
                        const IdentifiedModel& model,
                        TrajectorySamples* samples, std::string* error) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  StructuralDynamics::Prepared prepared;
  if (!dynamics.Prepare(model.parameters.head(dynamics.num_parameters()),
                        &prepared, error)) {
    return false;
  }
  Eigen::Index total = 0;
  for (const IdentificationRecord& record : problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    total += (record.num_samples() - 1) * record.substeps + 1;
  }
  Sampler sampler(dynamics, prepared, total);
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    if (!sampler.Run(record, StartOfRun(problem, model, r), error)) {
      return false;
    }
  }
  *samples = sampler.Take();
  return true;
}

Matrix FeatureValues(const std::vector<Feature>& features, int num_dofs,
                     const TrajectorySamples& samples) {
  Matrix values(samples.num_samples(),
                static_cast<Eigen::Index>(features.size()));
  for (size_t f = 0; f < features.size(); ++f) {
    const Feature& feature = features[f];
    auto column = values.col(static_cast<Eigen::Index>(f));
    if (feature.kind == Feature::Kind::kTime) {
      column = samples.times;
    } else if (feature.kind == Feature::Kind::kInput) {
      column = samples.inputs.row(feature.input).transpose();
    } else {
      column = (feature.Selector(num_dofs) *
                samples.states.middleRows(feature.OnVelocity() ? num_dofs : 0,
                                          num_dofs))
                   .transpose();
    }
  }
  return values;
}

}  // namespace pinode
