#include "pinode/estimate/input_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/rk4.h"
#include "pinode/integrate/tangent_step.h"

namespace pinode {

Matrix InputSensitivity(const IdentificationProblem& problem,
                        const ParameterLayout& layout, int record, int input,
                        const Vector& parameters, const Matrix& states,
                        const Matrix& weights) {
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  const StructuralDynamics& dynamics = *problem.dynamics;
  const int ns = dynamics.num_states();
  const int samples = data.num_samples();
  const int nc = static_cast<int>(data.channels.size());
  const int columns = static_cast<int>(weights.cols());
  CHECK_EQ(states.cols(), samples);
  CHECK_EQ(weights.rows(), nc * samples);

  StructuralDynamics::Prepared prepared;
  std::string error;
  CHECK(dynamics.Prepare(parameters.head(layout.num_dynamics()), &prepared,
                         &error))
      << error;
  std::vector<Observation> observations;
  Vector gains = Vector::Ones(nc);
  for (int c = 0; c < nc; ++c) {
    const MeasuredChannel& channel = data.channels[static_cast<size_t>(c)];
    observations.push_back(channel.observation);
    if (channel.gain >= 0) {
      gains[c] = parameters[layout.num_dynamics() + channel.gain];
    }
  }
  const ObservationMap observation(dynamics, observations);
  const IntegrationGrid grid(*data.excitation, data.substeps);
  const bool held = data.excitation->interpolation() == Interpolation::kHeld;

  // The dynamics is affine in its ground accelerations and forces, and smooth
  // in covariates: differences over a small part of the input's own size.
  const double delta =
      1e-4 *
      std::max(1e-12,
               data.excitation->samples().row(input).cwiseAbs().maxCoeff());
  auto stage = dynamics.MakeStage();
  Rk4Scratch<double> scratch(ns);
  std::vector<double> inputs(static_cast<size_t>(dynamics.num_inputs()));
  const auto perturbed = [&](const double* values, double step) {
    std::copy(values, values + inputs.size(), inputs.begin());
    inputs[static_cast<size_t>(input)] += step;
    return inputs.data();
  };
  // State at the end of an interval when the sample at its left (or right) end
  // is changed by `step`.
  const auto interval_end = [&](int i, bool left, double step) {
    Vector state = states.col(i);
    for (int s = 0; s < grid.substeps(); ++s) {
      Rk4Step(
          [&](int node, double time, const double* h, double* rate) {
            const double fraction = (s + 0.5 * node) / grid.substeps();
            const double share =
                held ? (left ? 1.0 : 0.0) : (left ? 1.0 - fraction : fraction);
            dynamics.Rate(prepared, time,
                          perturbed(grid.AtNode(i, s, node), step * share), h,
                          rate, &stage);
          },
          grid.step_time(i, s), grid.step(), state.data(), &scratch);
    }
    return state;
  };
  const auto observed = [&](int i, double step) {
    Vector rate(ns), y(nc);
    const double* values = perturbed(grid.AtSample(i), step);
    dynamics.Rate(prepared, grid.time(i), values, states.col(i).data(),
                  rate.data(), &stage);
    observation.Observe(states.col(i).data(), rate.data(), values, y.data());
    return y;
  };

  Matrix result = Matrix::Zero(columns, samples);
  Matrix adjoint = Matrix::Zero(columns, ns);
  TangentStep step(dynamics);
  Matrix state_jacobian, transition;
  for (int i = samples - 1; i >= 0; --i) {
    if (i + 1 < samples) {
      const Vector by_left =
          (interval_end(i, true, delta) - interval_end(i, true, -delta)) /
          (2.0 * delta);
      result.col(i) += adjoint * by_left;
      if (!held) {
        const Vector by_right =
            (interval_end(i, false, delta) - interval_end(i, false, -delta)) /
            (2.0 * delta);
        result.col(i + 1) += adjoint * by_right;
      }
      transition = Matrix::Identity(ns, ns);
      Vector state = states.col(i);
      for (int s = 0; s < grid.substeps(); ++s) {
        step.Step(prepared, grid, i, s, false, false, &state, &transition);
      }
      adjoint = adjoint * transition;
    }
    const auto& linearized = step.LinearizeAt(
        prepared, grid.time(i), grid.AtSample(i), states.col(i).data());
    observation.StateJacobian(linearized, &state_jacobian);
    const Matrix weight =
        weights.middleRows(i * nc, nc).transpose() * gains.asDiagonal();
    adjoint += weight * state_jacobian;
    result.col(i) +=
        weight * (observed(i, delta) - observed(i, -delta)) / (2.0 * delta);
  }
  return result;
}

}  // namespace pinode
