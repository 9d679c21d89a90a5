#include "pinode/integrate/free_run.h"

#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/integrate/rk4.h"

namespace pinode {

bool FreeRun(const StructuralDynamics& dynamics,
             const StructuralDynamics::Prepared& prepared,
             const ObservationMap& observation, const IntegrationGrid& grid,
             const Vector& start, int first_sample, int last_sample,
             Trajectory* trajectory) {
  const int ns = dynamics.num_states();
  CHECK_EQ(start.size(), ns) << "the start needs one value per state";
  CHECK_LE(0, first_sample);
  CHECK_LE(first_sample, last_sample);
  CHECK_LE(last_sample, grid.num_intervals());
  const int samples = last_sample - first_sample + 1;
  constexpr double kLargest = 1e100;

  trajectory->first_sample = first_sample;
  trajectory->failed_sample = -1;
  trajectory->failed_state = -1;
  trajectory->states = Matrix::Constant(ns, samples, kNaN);
  trajectory->rates = Matrix::Constant(ns, samples, kNaN);
  trajectory->channels =
      Matrix::Constant(observation.num_channels(), samples, kNaN);

  auto stage = dynamics.MakeLinearization();
  Rk4Scratch<double> scratch(ns);
  Vector state = start;
  dynamics.Prescribe(grid.AtSample(first_sample), state.data());
  for (int i = first_sample; i <= last_sample; ++i) {
    for (int k = 0; k < ns; ++k) {
      if (!(std::abs(state[k]) < kLargest)) {
        trajectory->failed_sample = i;
        trajectory->failed_state = k;
        return false;
      }
    }
    const int column = i - first_sample;
    trajectory->states.col(column) = state;
    dynamics.Rate(prepared, grid.time(i), grid.AtSample(i), state.data(),
                  trajectory->rates.col(column).data(), &stage);
    observation.Observe(state.data(), trajectory->rates.col(column).data(),
                        grid.AtSample(i),
                        trajectory->channels.col(column).data());
    if (i == last_sample) break;
    for (int s = 0; s < grid.substeps(); ++s) {
      Rk4Step(
          [&](int node, double time, const double* h, double* rate) {
            dynamics.Rate(prepared, time, grid.AtNode(i, s, node), h, rate,
                          &stage);
          },
          grid.step_time(i, s), grid.step(), state.data(), &scratch);
      dynamics.Prescribe(grid.AtNode(i, s, 2), state.data());
    }
  }
  return true;
}

}  // namespace pinode
