#include "pinode/integrate/segment.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/logging.h"
#include "pinode/base/small_matrix.h"
#include "pinode/integrate/free_run.h"

namespace pinode {
namespace {

// Number of exponential steps computed before their sensitivities.
constexpr Eigen::Index kStepBlock = 32;

// Computes kRows rows of diag(map) * sensitivity.
template <int kRows>
void ScaleRows(const Matrix& map, const Matrix& sensitivity, Eigen::Index first,
               Eigen::Ref<Matrix>* rows) {
  using Column = Eigen::Array<double, kRows, 1>;
  const Column factors = map.diagonal().segment<kRows>(first);
  for (Eigen::Index j = 0; j < sensitivity.cols(); ++j) {
    Eigen::Map<Column>(rows->col(j).data() + first) =
        factors * Eigen::Map<const Column>(sensitivity.col(j).data() + first);
  }
}

// Computes *rows = map * sensitivity.
void MapColumns(const Matrix& map, const Matrix& sensitivity,
                Eigen::Ref<Matrix> rows) {
  if (map.rows() != map.cols() || !map.isDiagonal(0.0)) {
    Multiply(map, sensitivity, rows);
    return;
  }
  // The whole state in its order, as in simulated records. A product would take
  // as long as the step itself.
  Eigen::Index first = 0;
  for (; first + 8 <= map.rows(); first += 8) {
    ScaleRows<8>(map, sensitivity, first, &rows);
  }
  for (; first + 2 <= map.rows(); first += 2) {
    ScaleRows<2>(map, sensitivity, first, &rows);
  }
  if (first < map.rows()) ScaleRows<1>(map, sensitivity, first, &rows);
}

}  // namespace

void SegmentTangents::ApplyFactors() {
  const Eigen::Index count = factors.size();
  auto own = jacobian();
  for (Eigen::Index j = 0; count > 0 && j < own.cols(); ++j) {
    Eigen::Map<Matrix>(own.col(j).data(), count, own.rows() / count)
        .array()
        .colwise() *= factors.array();
  }
}

int FirstNotFinite(const Vector& state) {
  constexpr double kLargest = 1e100;
  for (int k = 0; k < state.size(); ++k) {
    if (!(std::abs(state[k]) < kLargest)) return k;
  }
  return -1;
}

SegmentPropagator::SegmentPropagator(const StructuralDynamics& dynamics,
                                     DerivativeMethod method)
    : dynamics_(dynamics),
      method_(method),
      linear_(dynamics),
      step_(dynamics) {}

bool SegmentPropagator::Propagate(const StructuralDynamics::Prepared& prepared,
                                  const ObservationMap& observation,
                                  const IntegrationGrid& grid,
                                  const Vector& start, Eigen::Index first,
                                  Eigen::Index last, bool observe_last,
                                  SegmentColumns columns,
                                  SegmentTangents* result) {
  CHECK_LE(0, first);
  CHECK_LT(first, last);
  CHECK_LE(last, grid.num_intervals());
  CHECK_EQ(start.size(), dynamics_.num_states());
  if (grid.integrator() == Integrator::kExponential) {
    if (!exponential_.has_value()) exponential_.emplace(dynamics_);
    exponential_->Prepare(prepared, grid.step(), HasParameters(columns));
    return PropagateTangents(prepared, observation, grid, start, first, last,
                             observe_last, columns, result);
  }
  if (columns == SegmentColumns::kNone) {
    return Run(prepared, observation, grid, start, first, last, observe_last,
               result);
  }
  if (grid.integrator() == Integrator::kExact) {
    return linear_.Propagate(prepared, observation, grid, start, first, last,
                             observe_last, columns, result);
  }
  switch (method_) {
    case DerivativeMethod::kTangents:
      if (LinearSegment::Suits(dynamics_, grid.substeps())) {
        return linear_.Propagate(prepared, observation, grid, start, first,
                                 last, observe_last, columns, result);
      }
      return PropagateTangents(prepared, observation, grid, start, first, last,
                               observe_last, columns, result);
    case DerivativeMethod::kJets:
      // Jets do not see that the instant of a switch moves.
      if (dynamics_.num_switches() > 0) {
        return PropagateTangents(prepared, observation, grid, start, first,
                                 last, observe_last, columns, result);
      }
      return PropagateWithJets(dynamics_, prepared, observation, grid, start,
                               first, last, observe_last, columns, result);
  }
  return false;
}

bool SegmentPropagator::Run(const StructuralDynamics::Prepared& prepared,
                            const ObservationMap& observation,
                            const IntegrationGrid& grid, const Vector& start,
                            Eigen::Index first, Eigen::Index last,
                            bool observe_last, SegmentTangents* result) {
  Trajectory trajectory;
  const bool finite = FreeRun(dynamics_, prepared, observation, grid, start,
                              first, last, &trajectory, Keep::kChannels);
  result->failed_sample = trajectory.failed_sample;
  result->failed_state = trajectory.failed_state;
  if (!finite) return false;
  const Eigen::Index samples = last - first + (observe_last ? 1 : 0);
  result->channels = trajectory.channels.leftCols(samples);
  result->ResizeJacobian(result->channels.size(), 0);
  result->end_state = trajectory.states.rightCols(1);
  result->end_sensitivity.resize(dynamics_.num_states(), 0);
  return true;
}

bool SegmentPropagator::PropagateTangents(
    const StructuralDynamics::Prepared& prepared,
    const ObservationMap& observation, const IntegrationGrid& grid,
    const Vector& start, Eigen::Index first, Eigen::Index last,
    bool observe_last, SegmentColumns columns, SegmentTangents* result) {
  const int ns = dynamics_.num_states();
  const bool with_parameters = HasParameters(columns);
  const int np = with_parameters ? dynamics_.num_tangent_columns() : 0;
  const int by_start = HasStart(columns) ? ns : 0;
  const int channels = observation.num_channels();
  const Eigen::Index samples = last - first + (observe_last ? 1 : 0);
  const bool exponentially = grid.integrator() == Integrator::kExponential;
  result->failed_sample = -1;
  result->failed_state = -1;
  result->channels.resize(channels, samples);
  result->ResizeJacobian(channels * samples, by_start + np);
  auto jacobian = result->jacobian();
  const Vector& factors = result->factors;
  const bool direct = observation.uses_acceleration() && np > 0;
  if (direct) {
    direct_.resize(observation.rate_map().rows(), np);
  }

  state_ = start;
  sensitivity_.resize(ns, by_start + np);
  sensitivity_.setZero();
  sensitivity_.leftCols(by_start).setIdentity();
  dynamics_.Prescribe(grid.AtSample(first), state_.data());
  dynamics_.PrescribeSensitivity(&sensitivity_);
  step_.Begin(prepared, grid.time(first), grid.AtSample(first), state_.data());
  Eigen::Index block =
      first;  // the sample at which the last block of steps begins
  for (Eigen::Index i = first; i <= last; ++i) {
    if (exponentially && sensitivity_.cols() > 0) {
      if (i > first) {
        state_ = exponential_->states().col((i - block) * grid.substeps());
      }
      if (i < last && (i - first) % kStepBlock == 0) {
        block = i;
        exponential_->RunBlock(prepared, grid, i,
                               std::min(kStepBlock, last - i) * grid.substeps(),
                               with_parameters, state_);
      }
    }
    const int failed = FirstNotFinite(state_);
    if (failed >= 0) {
      result->failed_sample = i;
      result->failed_state = failed;
      return false;
    }
    const bool observed = i < last || observe_last;
    if (observed) {
      const Eigen::Index row = (i - first) * channels;
      const auto& stage = step_.LinearizeAt(prepared, grid.time(i),
                                            grid.AtSample(i), state_.data());
      observation.Observe(state_.data(), stage.rate.data(), grid.AtSample(i),
                          result->channels.col(i - first).data());
      observation.StateJacobian(stage, &state_jacobian_);
      if (factors.size() > 0) {
        state_jacobian_.array().colwise() *= factors.array();
      }
      MapColumns(state_jacobian_, sensitivity_,
                 jacobian.middleRows(row, channels));
      if (direct) {
        direct_.setZero();
        step_.AddParameterTangents(prepared, observation.rate_map(), &direct_);
        const std::vector<int>& rows = observation.acceleration_rows();
        for (size_t r = 0; r < rows.size(); ++r) {
          jacobian.row(row + rows[r]).tail(np) +=
              (factors.size() > 0 ? factors[rows[r]] : 1.0) *
              direct_.row(static_cast<Eigen::Index>(r));
        }
      }
    }
    if (i == last) break;
    for (int s = 0; s < grid.substeps(); ++s) {
      if (exponentially && sensitivity_.cols() == 0) {
        exponential_->Advance(prepared, grid, i, s, &state_);
        continue;
      }
      if (exponentially) {
        exponential_->StepSensitivity((i - block) * grid.substeps() + s,
                                      with_parameters, &sensitivity_);
        continue;
      }
      step_.Step(prepared, grid, i, s, observed && s == 0, with_parameters,
                 &state_, &sensitivity_);
    }
  }
  result->end_state = state_;
  result->end_sensitivity = sensitivity_;
  return true;
}

}  // namespace pinode
