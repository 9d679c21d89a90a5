#include "pinode/estimate/certainty/input_noise.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/rk4.h"
#include "pinode/integrate/tangent_step.h"

namespace pinode {

namespace {

// Returns the sensors' gains, one per channel of a record; ideal sensors have
// 1.
Vector GainsOf(const IdentificationRecord& record,
               const ParameterLayout& layout, const Vector& parameters) {
  Vector gains = Vector::Ones(static_cast<int>(record.channels.size()));
  for (int c = 0; c < gains.size(); ++c) {
    const int gain = record.channels[static_cast<size_t>(c)].gain;
    if (gain >= 0) gains[c] = parameters[layout.num_dynamics() + gain];
  }
  return gains;
}

// Linearises a record sample by sample along its states, see LinearizedRecord.
class RecordLinearizer {
 public:
  RecordLinearizer(const StructuralDynamics& dynamics,
                   const StructuralDynamics::Prepared& prepared,
                   const IdentificationRecord& record,
                   const std::vector<int>& inputs, const Vector& gains,
                   const Matrix& states)
      : dynamics_(dynamics),
        prepared_(prepared),
        inputs_(inputs),
        gains_(gains),
        states_(states),
        observation_(dynamics, record.Observations()),
        grid_(*record.excitation, record.substeps),
        held_(record.excitation->interpolation() == Interpolation::kHeld),
        deltas_(static_cast<int>(inputs.size())),
        step_(dynamics),
        linearization_(dynamics.MakeLinearization()),
        scratch_(dynamics.num_states()),
        values_(static_cast<size_t>(dynamics.num_inputs())) {
    // The dynamics is affine in its ground accelerations and forces, and smooth
    // in covariates: differences over a small part of the input's own size.
    for (int j = 0; j < deltas_.size(); ++j) {
      const auto row = record.excitation->samples().row(Input(j));
      deltas_[j] = 1e-4 * std::max(1e-12, row.cwiseAbs().maxCoeff());
    }
  }

  // Linearises the observations at sample `i`.
  void LinearizeSample(Eigen::Index i, LinearizedRecord::Sample* sample) {
    const auto& linearized = step_.LinearizeAt(
        prepared_, grid_.time(i), grid_.AtSample(i), states_.col(i).data());
    observation_.StateJacobian(linearized, &state_jacobian_);
    sample->by_state = gains_.asDiagonal() * state_jacobian_;
    sample->by_input.resize(gains_.size(), deltas_.size());
    for (int j = 0; j < deltas_.size(); ++j) {
      sample->by_input.col(j) =
          (Observed(i, j, deltas_[j]) - Observed(i, j, -deltas_[j])) /
          (2.0 * deltas_[j]);
    }
    sample->by_input = gains_.asDiagonal() * sample->by_input;
  }

  // Linearises the interval from sample `i` to the next one.
  void LinearizeInterval(Eigen::Index i, LinearizedRecord::Sample* sample) {
    const int ns = dynamics_.num_states();
    sample->transition = Matrix::Identity(ns, ns);
    Vector state = states_.col(i);
    step_.Begin(prepared_, grid_.time(i), grid_.AtSample(i), state.data());
    for (int s = 0; s < grid_.substeps(); ++s) {
      step_.Step(prepared_, grid_, i, s, false, false, &state,
                 &sample->transition);
    }
    sample->left = Matrix::Zero(ns, deltas_.size());
    sample->right = Matrix::Zero(ns, deltas_.size());
    for (int j = 0; j < deltas_.size(); ++j) {
      const auto difference = [&](bool left) {
        return Vector((IntervalEnd(i, j, left, deltas_[j]) -
                       IntervalEnd(i, j, left, -deltas_[j])) /
                      (2.0 * deltas_[j]));
      };
      sample->left.col(j) = difference(true);
      if (!held_) sample->right.col(j) = difference(false);
    }
  }

 private:
  int Input(int j) const { return inputs_[static_cast<size_t>(j)]; }

  // Returns the inputs `nominal` with noisy input `j` changed by `change`.
  const double* Changed(const double* nominal, int j, double change) {
    std::copy(nominal, nominal + values_.size(), values_.begin());
    values_[static_cast<size_t>(Input(j))] += change;
    return values_.data();
  }

  Vector Observed(Eigen::Index i, int j, double change) {
    Vector rate(dynamics_.num_states()), y(gains_.size());
    const double* at = Changed(grid_.AtSample(i), j, change);
    dynamics_.Rate(prepared_, grid_.time(i), at, states_.col(i).data(),
                   rate.data(), &linearization_);
    observation_.Observe(states_.col(i).data(), rate.data(), at, y.data());
    return y;
  }

  // Returns the state at the end of an interval when the sample at its left (or
  // right) end is changed.
  Vector IntervalEnd(Eigen::Index i, int j, bool left, double change) {
    Vector state = states_.col(i);
    for (int s = 0; s < grid_.substeps(); ++s) {
      Rk4Step(
          [&](int node, double time, const double* h, double* rate) {
            const double fraction = (s + 0.5 * node) / grid_.substeps();
            const double share =
                held_ ? (left ? 1.0 : 0.0) : (left ? 1.0 - fraction : fraction);
            dynamics_.Rate(prepared_, time,
                           Changed(grid_.AtNode(i, s, node), j, change * share),
                           h, rate, &linearization_);
          },
          grid_.step_time(i, s), grid_.step(), state.data(), &scratch_);
    }
    return state;
  }

  const StructuralDynamics& dynamics_;
  const StructuralDynamics::Prepared& prepared_;
  const std::vector<int>& inputs_;  // those that have noise
  const Vector& gains_;
  const Matrix& states_;
  const ObservationMap observation_;
  const IntegrationGrid grid_;
  const bool held_;
  Vector deltas_;  // per noisy input
  // Scratch.
  TangentStep step_;
  StructuralDynamics::Linearization linearization_;
  Rk4Scratch<double> scratch_;
  std::vector<double> values_;
  Matrix state_jacobian_;
};

}  // namespace

LinearizedRecord LinearizeRecord(const IdentificationProblem& problem,
                                 const ParameterLayout& layout, int record,
                                 const std::vector<int>& inputs,
                                 const Vector& parameters,
                                 const Matrix& states) {
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  CHECK_EQ(states.cols(), data.num_samples());
  StructuralDynamics::Prepared prepared;
  std::string error;
  CHECK(problem.dynamics->Prepare(parameters.head(layout.num_dynamics()),
                                  &prepared, &error))
      << error;
  const Vector gains = GainsOf(data, layout, parameters);
  RecordLinearizer linearizer(*problem.dynamics, prepared, data, inputs, gains,
                              states);
  LinearizedRecord result;
  result.samples.resize(static_cast<size_t>(data.num_samples()));
  for (Eigen::Index i = 0; i < data.num_samples(); ++i) {
    LinearizedRecord::Sample& sample = result.samples[static_cast<size_t>(i)];
    linearizer.LinearizeSample(i, &sample);
    if (i + 1 < data.num_samples()) linearizer.LinearizeInterval(i, &sample);
  }
  return result;
}

Matrix InputSensitivity(const LinearizedRecord& record, int input,
                        const Matrix& weights) {
  const auto samples = static_cast<Eigen::Index>(record.samples.size());
  const int nc = static_cast<int>(record.samples[0].by_state.rows());
  const int ns = static_cast<int>(record.samples[0].by_state.cols());
  const int columns = static_cast<int>(weights.cols());
  CHECK_EQ(weights.rows(), nc * samples);
  Matrix result = Matrix::Zero(columns, samples);
  Matrix adjoint = Matrix::Zero(columns, ns);
  for (Eigen::Index i = samples - 1; i >= 0; --i) {
    const LinearizedRecord::Sample& sample =
        record.samples[static_cast<size_t>(i)];
    if (i + 1 < samples) {
      result.col(i) += adjoint * sample.left.col(input);
      result.col(i + 1) += adjoint * sample.right.col(input);
      adjoint = adjoint * sample.transition;
    }
    const auto weight = weights.middleRows(i * nc, nc).transpose();
    adjoint += weight * sample.by_state;
    result.col(i) += weight * sample.by_input.col(input);
  }
  return result;
}

}  // namespace pinode
