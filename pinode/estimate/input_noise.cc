#include "pinode/estimate/input_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/rk4.h"
#include "pinode/integrate/tangent_step.h"

namespace pinode {

LinearizedRecord LinearizeRecord(const IdentificationProblem& problem,
                                 const ParameterLayout& layout, int record,
                                 const std::vector<int>& inputs,
                                 const Vector& parameters,
                                 const Matrix& states) {
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  const StructuralDynamics& dynamics = *problem.dynamics;
  const int ns = dynamics.num_states();
  const int samples = data.num_samples();
  const int nc = static_cast<int>(data.channels.size());
  const int ne = static_cast<int>(inputs.size());
  CHECK_EQ(states.cols(), samples);

  StructuralDynamics::Prepared prepared;
  std::string error;
  CHECK(dynamics.Prepare(parameters.head(layout.num_dynamics()), &prepared,
                         &error))
      << error;
  Vector gains = Vector::Ones(nc);
  for (int c = 0; c < nc; ++c) {
    const MeasuredChannel& channel = data.channels[static_cast<size_t>(c)];
    if (channel.gain >= 0) {
      gains[c] = parameters[layout.num_dynamics() + channel.gain];
    }
  }
  const ObservationMap observation(dynamics, data.Observations());
  const IntegrationGrid grid(*data.excitation, data.substeps);
  const bool held = data.excitation->interpolation() == Interpolation::kHeld;

  auto stage = dynamics.MakeLinearization();
  Rk4Scratch<double> scratch(ns);
  std::vector<double> values(static_cast<size_t>(dynamics.num_inputs()));
  const auto perturbed = [&](const double* nominal, int input, double step) {
    std::copy(nominal, nominal + values.size(), values.begin());
    values[static_cast<size_t>(input)] += step;
    return values.data();
  };
  // State at the end of an interval when the sample at its left (or right) end
  // is changed by `step`.
  const auto interval_end = [&](int i, int input, bool left, double step) {
    Vector state = states.col(i);
    for (int s = 0; s < grid.substeps(); ++s) {
      Rk4Step(
          [&](int node, double time, const double* h, double* rate) {
            const double fraction = (s + 0.5 * node) / grid.substeps();
            const double share =
                held ? (left ? 1.0 : 0.0) : (left ? 1.0 - fraction : fraction);
            dynamics.Rate(
                prepared, time,
                perturbed(grid.AtNode(i, s, node), input, step * share), h,
                rate, &stage);
          },
          grid.step_time(i, s), grid.step(), state.data(), &scratch);
    }
    return state;
  };
  const auto observed = [&](int i, int input, double step) {
    Vector rate(ns), y(nc);
    const double* at = perturbed(grid.AtSample(i), input, step);
    dynamics.Rate(prepared, grid.time(i), at, states.col(i).data(), rate.data(),
                  &stage);
    observation.Observe(states.col(i).data(), rate.data(), at, y.data());
    return y;
  };
  // The dynamics is affine in its ground accelerations and forces, and smooth
  // in covariates: differences over a small part of the input's own size.
  Vector delta(ne);
  for (int j = 0; j < ne; ++j) {
    const auto row =
        data.excitation->samples().row(inputs[static_cast<size_t>(j)]);
    delta[j] = 1e-4 * std::max(1e-12, row.cwiseAbs().maxCoeff());
  }

  LinearizedRecord result;
  result.samples.resize(static_cast<size_t>(samples));
  TangentStep step(dynamics);
  Matrix state_jacobian;
  for (int i = 0; i < samples; ++i) {
    LinearizedRecord::Sample& sample = result.samples[static_cast<size_t>(i)];
    const auto& linearized = step.LinearizeAt(
        prepared, grid.time(i), grid.AtSample(i), states.col(i).data());
    observation.StateJacobian(linearized, &state_jacobian);
    sample.by_state = gains.asDiagonal() * state_jacobian;
    sample.by_input.resize(nc, ne);
    for (int j = 0; j < ne; ++j) {
      const int input = inputs[static_cast<size_t>(j)];
      sample.by_input.col(j) =
          (observed(i, input, delta[j]) - observed(i, input, -delta[j])) /
          (2.0 * delta[j]);
    }
    sample.by_input = gains.asDiagonal() * sample.by_input;
    if (i + 1 == samples) break;
    sample.transition = Matrix::Identity(ns, ns);
    Vector state = states.col(i);
    for (int s = 0; s < grid.substeps(); ++s) {
      step.Step(prepared, grid, i, s, false, false, &state, &sample.transition);
    }
    sample.left = Matrix::Zero(ns, ne);
    sample.right = Matrix::Zero(ns, ne);
    for (int j = 0; j < ne; ++j) {
      const int input = inputs[static_cast<size_t>(j)];
      const auto difference = [&](bool left) {
        return Vector((interval_end(i, input, left, delta[j]) -
                       interval_end(i, input, left, -delta[j])) /
                      (2.0 * delta[j]));
      };
      sample.left.col(j) = difference(true);
      if (!held) sample.right.col(j) = difference(false);
    }
  }
  return result;
}

Matrix InputSensitivity(const LinearizedRecord& record, int input,
                        const Matrix& weights) {
  const int samples = static_cast<int>(record.samples.size());
  const int nc = static_cast<int>(record.samples[0].by_state.rows());
  const int ns = static_cast<int>(record.samples[0].by_state.cols());
  const int columns = static_cast<int>(weights.cols());
  CHECK_EQ(weights.rows(), nc * samples);
  Matrix result = Matrix::Zero(columns, samples);
  Matrix adjoint = Matrix::Zero(columns, ns);
  for (int i = samples - 1; i >= 0; --i) {
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
