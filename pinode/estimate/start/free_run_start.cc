#include "pinode/estimate/start/free_run_start.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "pinode/base/constants.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/start/initial_states.h"
#include "pinode/integrate/free_run.h"
#include "pinode/integrate/segment.h"
#include "pinode/problem/assumed_noise.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/record_grid.h"

namespace pinode {
namespace {

// Share of a hold-out record from which its start is smoothed.
constexpr double kStartShare = 0.05;
// Limits of a steady state: change over a period, relative to the states' RMS,
// and number of periods that are run.
constexpr double kSteadyChange = 1e-9;
constexpr int kMostPeriods = 200;

// Returns the record's beginning as a training record. The excitation continues
// as long as it affects the samples before: it is known.
IdentificationRecord Beginning(const IdentificationRecord& data,
                               Eigen::Index samples) {
  IdentificationRecord beginning = data;
  const Eigen::Index count =
      std::min(data.num_samples(), samples + data.excitation->reach());
  beginning.role = IdentificationRecord::Role::kTrain;
  beginning.filter = nullptr;
  beginning.excitation.emplace(data.excitation->start_time(),
                               data.excitation->step(),
                               data.excitation->samples().leftCols(count),
                               data.excitation->interpolation());
  for (MeasuredChannel& channel : beginning.channels) {
    channel.values = Vector(channel.values.head(count));
    channel.values.tail(count - samples).setConstant(kNaN);
  }
  return beginning;
}

// Returns the start smoothed from the first `samples` alone.
Vector SmoothedStart(const IdentificationProblem& problem, int record,
                     const Vector& parameters, const Vector& sigmas,
                     Eigen::Index samples) {
  IdentificationProblem beginning = problem;
  beginning.records = {
      Beginning(problem.records[static_cast<size_t>(record)], samples)};
  beginning.modal = ModalData();
  const int ns = problem.dynamics->num_states();
  const ParameterLayout layout(beginning);
  MultipleShooting shooting(beginning, layout, MultipleShooting::Options());
  shooting.SetSigmas({sigmas});
  shooting.SetStateScales({GuessStateScales(beginning, beginning.records[0])});
  SetSegmentsAtRest(0, &shooting);
  // The free parameters take the values given; fixed ones are the problem's.
  double cost = 0.0;
  if (!shooting.Evaluate(layout.Free(parameters), &cost)) {
    return Vector::Zero(ns);
  }
  return shooting.starts()[0].col(0);
}

}  // namespace

Eigen::Index FreeRunStart(const IdentificationProblem& problem, int record,
                          const Vector& parameters, const Vector& sigmas,
                          Vector* start) {
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  if (data.start == IdentificationRecord::Start::kRest) {
    *start = Vector::Zero(problem.dynamics->num_states());
    return 0;
  }
  if (data.start == IdentificationRecord::Start::kKnown) {
    *start = data.known_start;
    return 0;
  }
  if (data.excitation->periodic() &&
      FindSteadyState(problem, record, parameters, start)) {
    return 0;
  }
  const Eigen::Index samples =
      data.start_samples > 0
          ? data.start_samples
          : std::clamp(
                static_cast<Eigen::Index>(std::ceil(
                    kStartShare * static_cast<double>(data.num_samples()))),
                std::min<Eigen::Index>(data.num_samples(), 8),
                data.num_samples());
  *start = SmoothedStart(problem, record, parameters, sigmas, samples);
  return data.role == IdentificationRecord::Role::kHoldout ? samples : 0;
}

void FixTrainingStarts(IdentificationProblem* problem) {
  const Vector parameters = ParameterLayout(*problem).InitialValues();
  for (size_t r = 0; r < problem->records.size(); ++r) {
    IdentificationRecord& record = problem->records[r];
    if (record.role != IdentificationRecord::Role::kTrain ||
        record.start != IdentificationRecord::Start::kFree ||
        record.start_samples == 0) {
      continue;
    }
    record.known_start = SmoothedStart(
        *problem, static_cast<int>(r), parameters,
        AssumedNoise(Beginning(record, record.start_samples), NoiseTuning()),
        record.start_samples);
    record.start = IdentificationRecord::Start::kKnown;
  }
}

bool FindSteadyState(const IdentificationProblem& problem, int record,
                     const Vector& parameters, Vector* start) {
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  const StructuralDynamics& dynamics = *problem.dynamics;
  const int ns = dynamics.num_states();
  *start = Vector::Zero(ns);
  StructuralDynamics::Prepared prepared;
  std::string error;
  if (!data.excitation->periodic() ||
      parameters.size() < dynamics.num_parameters() ||
      !dynamics.Prepare(parameters.head(dynamics.num_parameters()), &prepared,
                        &error)) {
    return false;
  }
  const IntegrationGrid grid = GridOf(dynamics, data);
  const ObservationMap nothing(dynamics, {});
  Trajectory trajectory;
  if (!FreeRun(dynamics, prepared, nothing, grid, *start, 0,
               grid.num_intervals(), &trajectory)) {
    return false;
  }
  const Vector scales = StateScales(problem, trajectory.states);
  *start = trajectory.states.rightCols(1);
  SegmentPropagator propagator(dynamics, DerivativeMethod::kTangents);
  SegmentTangents period;
  double smallest = kInfinity;
  Vector after_smallest = *start;
  for (int i = 1; i < kMostPeriods; ++i) {
    if (!propagator.Propagate(prepared, nothing, grid, *start, 0,
                              grid.num_intervals(), false,
                              SegmentColumns::kStart, &period)) {
      if (std::isinf(smallest)) return false;
      *start = after_smallest;
      continue;
    }
    const Vector change = period.end_state - *start;
    const double size = change.cwiseQuotient(scales).norm() /
                        std::sqrt(static_cast<double>(ns));
    if (size < kSteadyChange) return true;
    // A Newton step that made it worse is undone.
    const bool better = size < smallest;
    if (!better) {
      *start = after_smallest;
      smallest = kInfinity;
      continue;
    }
    smallest = size;
    after_smallest = period.end_state;
    const Eigen::PartialPivLU<Matrix> lu(
        Matrix(Matrix::Identity(ns, ns) - period.end_sensitivity.leftCols(ns)));
    const Vector next = *start + lu.solve(change);
    *start = next.allFinite() ? next : period.end_state;
  }
  return false;
}

}  // namespace pinode
