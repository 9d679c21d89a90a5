#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pinode/integrate/rk4.h"
#include "pinode/integrate/segment.h"

namespace pinode {

bool PropagateWithJets(const StructuralDynamics& dynamics,
                       const StructuralDynamics::Prepared& prepared,
                       const ObservationMap& observation,
                       const IntegrationGrid& grid, const Vector& start,
                       Eigen::Index first, Eigen::Index last, bool observe_last,
                       SegmentColumns wanted, SegmentTangents* result) {
  constexpr int kWidth = WideJet::DIMENSION;
  const int ns = dynamics.num_states();
  const int np = dynamics.num_parameters();
  const int by_start = HasStart(wanted) ? ns : 0;
  const int columns =
      by_start + (HasParameters(wanted) ? dynamics.num_tangent_columns() : 0);
  const int channels = observation.num_channels();
  const Eigen::Index samples = last - first + (observe_last ? 1 : 0);
  result->failed_sample = -1;
  result->failed_state = -1;
  result->channels.resize(channels, samples);
  result->ResizeJacobian(channels * samples, columns);
  auto jacobian = result->jacobian();
  result->end_state.resize(ns);
  result->end_sensitivity.resize(ns, columns);

  Rk4Scratch<WideJet> scratch(ns);
  std::vector<WideJet> state(static_cast<size_t>(ns));
  std::vector<WideJet> rate(static_cast<size_t>(ns));
  std::vector<WideJet> theta(static_cast<size_t>(np));
  Vector value(ns), value_rate(ns), y(channels);
  // One pass through the segment per chunk of columns.
  for (int begin = 0; begin < columns; begin += kWidth) {
    const int width = std::min(kWidth, columns - begin);
    for (int k = 0; k < ns; ++k) state[k] = WideJet(start[k]);
    for (int k = 0; k < np; ++k) theta[k] = WideJet(prepared.theta[k]);
    for (int k = 0; k < width; ++k) {
      const int column = begin + k;
      if (column < by_start) {
        state[column].v[k] = 1.0;
      } else {
        theta[dynamics.tangent_columns()[column - by_start]].v[k] = 1.0;
      }
    }
    ApplyTies(dynamics.ties(), theta.data());
    dynamics.Prescribe(grid.AtSample(first), state.data());
    for (Eigen::Index i = first; i <= last; ++i) {
      for (int k = 0; k < ns; ++k) {
        if (!(std::abs(state[k].a) < 1e100)) {
          result->failed_sample = i;
          result->failed_state = k;
          return false;
        }
      }
      if (i < last || observe_last) {
        dynamics.Rate(prepared, grid.time(i), grid.AtSample(i), state.data(),
                      theta.data(), rate.data());
        const Eigen::Index row = (i - first) * channels;
        for (int k = 0; k < ns; ++k) {
          value[k] = state[k].a;
          value_rate[k] = rate[k].a;
        }
        observation.Observe(value.data(), value_rate.data(), grid.AtSample(i),
                            y.data());
        result->channels.col(i - first) = y;
        // Observation is affine: its derivative is the map of the
        // derivatives with the inputs at zero.
        const std::vector<double> no_input(
            static_cast<size_t>(grid.num_inputs()), 0.0);
        for (int c = 0; c < width; ++c) {
          for (int k = 0; k < ns; ++k) {
            value[k] = state[k].v[c];
            value_rate[k] = rate[k].v[c];
          }
          observation.Observe(value.data(), value_rate.data(), no_input.data(),
                              y.data());
          jacobian.col(begin + c).segment(row, channels) = y;
        }
      }
      if (i == last) break;
      for (int s = 0; s < grid.substeps(); ++s) {
        Rk4Step(
            [&](int node, double time, const WideJet* h, WideJet* h_rate) {
              dynamics.Rate(prepared, time, grid.AtNode(i, s, node), h,
                            theta.data(), h_rate);
            },
            grid.step_time(i, s), grid.step(), state.data(), &scratch);
        dynamics.Prescribe(grid.AtNode(i, s, 2), state.data());
      }
    }
    for (int k = 0; k < ns; ++k) {
      result->end_state[k] = state[k].a;
      for (int c = 0; c < width; ++c) {
        result->end_sensitivity(k, begin + c) = state[k].v[c];
      }
    }
  }
  result->ApplyFactors();
  return true;
}

}  // namespace pinode
