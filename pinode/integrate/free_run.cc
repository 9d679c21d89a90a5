#include "pinode/integrate/free_run.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/integrate/exponential_step.h"
#include "pinode/integrate/history_pass.h"
#include "pinode/integrate/linear_map.h"
#include "pinode/integrate/modal_response.h"
#include "pinode/integrate/rk4.h"
#include "pinode/integrate/segment.h"
#include "pinode/integrate/switched_step.h"

namespace pinode {
namespace {

// Samples for each state above which a map pays off, and likewise modes.
constexpr int kSamplesForAMap = 3;
constexpr int kSamplesForModes = 40;
// Fewest samples for mean squares of states, which cost more than the channels.
constexpr int kSamplesForMeans = 16384;

// Performs the steps of one interval after the other: Advance moves the state
// from one sample to the next.
class Stepper {
 public:
  Stepper(const StructuralDynamics& dynamics,
          const StructuralDynamics::Prepared& prepared,
          const IntegrationGrid& grid, Eigen::Index samples)
      : dynamics_(dynamics),
        prepared_(prepared),
        grid_(grid),
        stage_(dynamics.MakeLinearization()),
        scratch_(dynamics.num_states()) {
    if (dynamics.IsLinear() &&
        (grid.integrator() == Integrator::kExact ||
         samples > Eigen::Index{kSamplesForAMap} * dynamics.num_states())) {
      map_.emplace(dynamics, prepared, grid, false);
    }
    if (grid.integrator() == Integrator::kExponential) {
      exponential_.emplace(dynamics);
      exponential_->Prepare(prepared, grid.step(), false);
    } else if (dynamics.num_switches() > 0) {
      switched_.emplace(dynamics);
    }
  }

  void RateAtSample(Eigen::Index sample, const double* state, double* rate) {
    dynamics_.Rate(prepared_, grid_.time(sample), grid_.AtSample(sample), state,
                   rate, &stage_);
  }

  void Advance(Eigen::Index interval, Vector* state) {
    if (map_.has_value()) {
      next_.noalias() = map_->transition() * *state;
      grid_.GetNodes(interval, 1, &nodes_);
      next_.noalias() += map_->forcing() * nodes_;
      state->swap(next_);
      return;
    }
    if (switched_.has_value() && !has_begun_) {
      switched_->Begin(prepared_, grid_.time(interval),
                       grid_.AtSample(interval), state->data());
      has_begun_ = true;
    }
    for (int s = 0; s < grid_.substeps(); ++s) {
      if (switched_.has_value()) {
        switched_->Step(prepared_, grid_, interval, s, state);
        continue;
      }
      if (exponential_.has_value()) {
        exponential_->Advance(prepared_, grid_, interval, s, state);
        continue;
      }
      Rk4Step(
          [&](int node, double time, const double* h, double* rate) {
            dynamics_.Rate(prepared_, time, grid_.AtNode(interval, s, node), h,
                           rate, &stage_);
          },
          grid_.step_time(interval, s), grid_.step(), state->data(), &scratch_);
      dynamics_.Prescribe(grid_.AtNode(interval, s, 2), state->data());
    }
  }

 private:
  const StructuralDynamics& dynamics_;
  const StructuralDynamics::Prepared& prepared_;
  const IntegrationGrid& grid_;
  StructuralDynamics::Linearization stage_;
  Rk4Scratch<double> scratch_;
  std::optional<LinearMap> map_;
  std::optional<ExponentialStep> exponential_;
  std::optional<SwitchedStep> switched_;
  bool has_begun_ = false;
  Vector next_;
  Matrix nodes_;
};

// Records the first state that is not finite. All later values are NaN.
bool EndWhereNotFinite(Trajectory* trajectory) {
  for (Eigen::Index i = 0; i < trajectory->states.cols(); ++i) {
    trajectory->failed_state = FirstNotFinite(trajectory->states.col(i));
    if (trajectory->failed_state < 0) continue;
    const Eigen::Index rest = trajectory->num_samples() - i;
    trajectory->failed_sample = trajectory->first_sample + i;
    trajectory->states.rightCols(rest).setConstant(kNaN);
    trajectory->channels.rightCols(rest).setConstant(kNaN);
    return false;
  }
  return true;
}

// Runs by the modes of linear dynamics. Returns false if they do not span the
// states. The caller detects a state that is not finite.
bool RunByModes(const StructuralDynamics& dynamics,
                const StructuralDynamics::Prepared& prepared,
                const ObservationMap& observation, const IntegrationGrid& grid,
                const Vector& start, Eigen::Index first, Keep keep,
                int num_threads, Trajectory* trajectory) {
  ModalResponse response;
  if (!response.Prepare(dynamics, prepared, grid, false)) return false;
  ModalResponse::Contents contents;
  contents.with_start = !start.isZero(0.0);
  const Matrix states = response.States(contents, start);
  const Matrix values = response.Values(contents, observation, start);
  const Eigen::Index samples = trajectory->num_samples();
  const Eigen::Index stride =
      std::max<Eigen::Index>(1, samples / kSamplesForMeans);
  const auto num_states = static_cast<double>(states.cols());
  const double combinations =
      static_cast<double>(values.cols()) +
      (keep == Keep::kAll           ? num_states
       : keep == Keep::kMeanSquares ? num_states / static_cast<double>(stride)
                                    : 0.0);
  const HistoryPass pass(
      response, contents, grid, first, samples,
      2.0 * static_cast<double>(values.rows()) * combinations);
  Matrix squares =
      Matrix::Zero(keep == Keep::kMeanSquares ? states.cols() : 0,
                   keep == Keep::kMeanSquares ? pass.num_pieces() : 0);
  pass.Visit(num_threads,
             [&](int, Eigen::Index begin, const Matrix& histories) {
               const auto count = histories.cols();
               trajectory->channels.middleCols(begin, count).noalias() =
                   values.transpose() * histories;
               if (keep == Keep::kAll) {
                 trajectory->states.middleCols(begin, count).noalias() =
                     states.transpose() * histories;
                 return;
               }
               if (keep == Keep::kMeanSquares) {
                 const Eigen::Index next = (stride - begin % stride) % stride;
                 const Matrix some =
                     histories(Eigen::all, Eigen::seq(next, count - 1, stride));
                 squares.col(HistoryPass::PieceOf(begin)) +=
                     (states.transpose() * some).rowwise().squaredNorm();
               }
               if (begin + count == samples) {
                 trajectory->states.noalias() =
                     states.transpose() * histories.rightCols(1);
               }
             });
  if (keep == Keep::kMeanSquares) {
    trajectory->mean_squares =
        squares.rowwise().sum() /
        static_cast<double>((samples + stride - 1) / stride);
  }
  return true;
}

}  // namespace

bool FreeRun(const StructuralDynamics& dynamics,
             const StructuralDynamics::Prepared& prepared,
             const ObservationMap& observation, const IntegrationGrid& grid,
             const Vector& start, Eigen::Index first_sample,
             Eigen::Index last_sample, Trajectory* trajectory, Keep keep,
             int num_threads) {
  const int ns = dynamics.num_states();
  CHECK_EQ(start.size(), ns) << "the start needs one value per state";
  CHECK_LE(0, first_sample);
  CHECK_LE(first_sample, last_sample);
  CHECK_LE(last_sample, grid.num_intervals());
  const Eigen::Index samples = last_sample - first_sample + 1;
  trajectory->first_sample = first_sample;
  trajectory->failed_sample = -1;
  trajectory->failed_state = -1;
  trajectory->states =
      Matrix::Constant(ns, keep == Keep::kAll ? samples : 1, kNaN);
  trajectory->channels =
      Matrix::Constant(observation.num_channels(), samples, kNaN);

  // Finding the state that did not stay finite, and its sample, requires all
  // states.
  const auto again = [&]() {
    return FreeRun(dynamics, prepared, observation, grid, start, first_sample,
                   last_sample, trajectory, Keep::kAll, num_threads);
  };
  if (dynamics.IsLinear() && samples > Eigen::Index{kSamplesForModes} * ns &&
      RunByModes(dynamics, prepared, observation, grid, start, first_sample,
                 keep, num_threads, trajectory)) {
    if (keep == Keep::kAll) return EndWhereNotFinite(trajectory);
    return (FirstNotFinite(trajectory->states.col(0)) < 0 &&
            trajectory->channels.allFinite()) ||
           again();
  }
  if (keep == Keep::kMeanSquares) trajectory->mean_squares = Vector::Zero(ns);
  Stepper stepper(dynamics, prepared, grid, samples);
  Vector state = start;
  Vector rate(ns);
  dynamics.Prescribe(grid.AtSample(first_sample), state.data());
  for (Eigen::Index i = first_sample; i <= last_sample; ++i) {
    trajectory->failed_state = FirstNotFinite(state);
    if (trajectory->failed_state >= 0) {
      trajectory->failed_sample = i;
      return keep == Keep::kAll ? false : again();
    }
    const Eigen::Index column = i - first_sample;
    trajectory->states.col(keep == Keep::kAll ? column : 0) = state;
    if (keep == Keep::kMeanSquares) {
      trajectory->mean_squares +=
          state.cwiseAbs2() / static_cast<double>(samples);
    }
    stepper.RateAtSample(i, state.data(), rate.data());
    observation.Observe(state.data(), rate.data(), grid.AtSample(i),
                        trajectory->channels.col(column).data());
    if (i < last_sample) stepper.Advance(i, &state);
  }
  return true;
}

}  // namespace pinode
