#include "pinode/estimate/segment_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include "pinode/estimate/shooting/residual_rows.h"
#include "pinode/estimate/start/initial_states.h"
#include "pinode/integrate/segment.h"
#include "pinode/problem/assumed_noise.h"
#include "pinode/problem/record_grid.h"

namespace pinode {

struct SegmentCost::Owned {
  Owned(const IdentificationProblem& given, int record, Eigen::Index from,
        Eigen::Index to, const Options& options)
      : problem(given),
        data(given.records[static_cast<size_t>(record)]),
        layout(given),
        first(from),
        last(to),
        sigmas(options.sigmas),
        gap_sigmas(options.gap_sigmas),
        grid(GridOf(*given.dynamics, data)),
        observation(*given.dynamics, data.Observations()),
        propagator(*given.dynamics, options.derivatives),
        rows(layout, RobustLoss::kNone, 1.0) {}

  bool HasGap() const { return last + 1 < data.num_samples(); }
  // True if the segment is the whole record.
  bool IsWhole() const { return first == 0 && !HasGap(); }

  const IdentificationProblem& problem;
  const IdentificationRecord& data;
  const ParameterLayout layout;
  const Eigen::Index first;
  const Eigen::Index last;
  const Vector sigmas;
  const Vector gap_sigmas;
  const IntegrationGrid grid;
  const ObservationMap observation;
  // Working memory.
  SegmentPropagator propagator;
  SegmentTangents tangents;
  ResidualRows rows;
  Matrix end_sensitivity;
};

namespace {

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Share of a state's size within which gaps are closed.
constexpr double kGapShare = 1e-3;

bool ArePositive(const Vector& values, Eigen::Index count) {
  return values.size() == count && values.allFinite() &&
         (values.array() > 0.0).all();
}

// Returns the maximum number: residuals of all samples, and of the gap after
// them.
Eigen::Index NumResiduals(Eigen::Index intervals, Eigen::Index channels,
                          Eigen::Index states) {
  return (intervals + 1) * channels + states;
}

bool IsRecord(const IdentificationProblem& problem, int record,
              std::string* error) {
  const int num_records = static_cast<int>(problem.records.size());
  if (record >= 0 && record < num_records) return true;
  *error = "there is no record " + std::to_string(record) + " among " +
           std::to_string(num_records);
  return false;
}

bool IsValidSegment(const IdentificationProblem& problem, int record,
                    Eigen::Index first, Eigen::Index last,
                    const SegmentCost::Options& options, std::string* error) {
  if (!IsRecord(problem, record, error)) return false;
  std::ostringstream message;
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  message << "record '" << data.name << "': ";
  const Eigen::Index samples = data.num_samples();
  const Eigen::Index channels = static_cast<Eigen::Index>(data.channels.size());
  const int states = problem.dynamics->num_states();
  if (first < 0 || first >= last || last >= samples) {
    message << "a segment from sample " << first << " to " << last
            << " is none of its " << samples << " samples";
  } else if (options.sigmas.size() > 0 &&
             !ArePositive(options.sigmas, channels)) {
    message << "its sigmas must be " << channels
            << " positive numbers, one per channel";
  } else if (options.gap_sigmas.size() > 0 &&
             !ArePositive(options.gap_sigmas, states)) {
    message << "gap_sigmas must be " << states
            << " positive numbers, one per state";
  } else if (data.filter != nullptr && (first > 0 || last + 1 < samples)) {
    message << "a filter needs the whole record in one segment";
  } else if (NumResiduals(last - first, channels, states) >
             std::numeric_limits<int>::max()) {
    message << "the residuals of a segment from sample " << first << " to "
            << last << " are more than Ceres can count, expected at most "
            << std::numeric_limits<int>::max();
  } else {
    return true;
  }
  *error = message.str();
  return false;
}

// Returns the state at `sample` from displacements and velocities at single
// DOFs; 0 for other states.
Vector ShownState(const IdentificationRecord& data, Eigen::Index sample,
                  int num_states) {
  Vector state = Vector::Zero(num_states);
  for (const MeasuredChannel& channel : data.channels) {
    const Vector& weights = channel.observation.weights;
    const Quantity quantity = channel.observation.quantity;
    const double value = channel.values[sample];
    Eigen::Index dof = 0;
    weights.cwiseAbs().maxCoeff(&dof);
    if ((quantity != Quantity::kDisplacement &&
         quantity != Quantity::kVelocity) ||
        (weights.array() != 0.0).count() != 1 || !std::isfinite(value)) {
      continue;
    }
    const Eigen::Index first =
        quantity == Quantity::kVelocity ? weights.size() : 0;
    state[first + dof] = value / weights[dof];
  }
  return state;
}

// Returns the initial starts of the segments that begin every `length` samples.
Matrix FirstStarts(const IdentificationProblem& problem,
                   const IdentificationRecord& data, Eigen::Index length,
                   Eigen::Index count) {
  const IdentificationRecord ideal = problem.AsSeenByIdealSensors(data);
  const int ns = problem.dynamics->num_states();
  Matrix starts(ns, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    starts.col(k) = ShownState(ideal, k * length, ns);
  }
  if (data.start == IdentificationRecord::Start::kRest) {
    starts.col(0).setZero();
  } else if (data.start == IdentificationRecord::Start::kKnown) {
    starts.col(0) = data.known_start;
  }
  return starts;
}

}  // namespace

std::unique_ptr<SegmentCost> SegmentCost::Create(
    const IdentificationProblem& problem, int record, Eigen::Index first,
    Eigen::Index last, const Options& options, std::string* error) {
  if (!problem.IsValid(error) ||
      !IsValidSegment(problem, record, first, last, options, error)) {
    return nullptr;
  }
  Options complete = options;
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  if (options.sigmas.size() == 0) {
    complete.sigmas = AssumedNoise(data, NoiseTuning());
  }
  if (options.gap_sigmas.size() == 0) {
    complete.gap_sigmas = kGapShare * GuessStateScales(problem, data);
  }
  return std::unique_ptr<SegmentCost>(new SegmentCost(
      std::make_unique<Owned>(problem, record, first, last, complete)));
}

bool SegmentCost::AddRecord(const IdentificationProblem& problem, int record,
                            Eigen::Index length, const Options& options,
                            double* free, Matrix* starts,
                            ceres::Problem* ceres_problem, std::string* error) {
  if (!problem.IsValid(error) || !IsRecord(problem, record, error)) {
    return false;
  }
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  if (length < 1) {
    *error = "record '" + data.name + "': segments of " +
             std::to_string(length) + " samples, expected at least 1";
    return false;
  }
  const Eigen::Index last = data.num_samples() - 1;
  std::vector<std::unique_ptr<SegmentCost>> segments;
  for (Eigen::Index first = 0; first < last; first += length) {
    segments.push_back(Create(problem, record, first,
                              std::min(last, first + length), options, error));
    if (segments.back() == nullptr) return false;
  }
  *starts = FirstStarts(problem, data, length,
                        static_cast<Eigen::Index>(segments.size()));
  for (size_t k = 0; k < segments.size(); ++k) {
    double* start = starts->col(static_cast<Eigen::Index>(k)).data();
    std::vector<double*> blocks = {start};
    if (segments[k]->HasGap()) blocks.push_back(start + starts->rows());
    blocks.push_back(free);
    ceres_problem->AddResidualBlock(segments[k].release(), nullptr, blocks);
  }
  if (data.start != IdentificationRecord::Start::kFree) {
    ceres_problem->SetParameterBlockConstant(starts->data());
  }
  return true;
}

SegmentCost::SegmentCost(std::unique_ptr<Owned> owned)
    : owned_(std::move(owned)) {
  const int ns = owned_->problem.dynamics->num_states();
  const Eigen::Index observed =
      owned_->last - owned_->first + (HasGap() ? 0 : 1);
  set_num_residuals(static_cast<int>(observed) *
                        owned_->observation.num_channels() +
                    (HasGap() ? ns : 0));
  mutable_parameter_block_sizes()->push_back(ns);
  if (HasGap()) mutable_parameter_block_sizes()->push_back(ns);
  mutable_parameter_block_sizes()->push_back(owned_->layout.num_free());
}

SegmentCost::~SegmentCost() = default;

bool SegmentCost::HasGap() const { return owned_->HasGap(); }

bool SegmentCost::Evaluate(double const* const* parameters, double* residuals,
                           double** jacobians) const {
  Owned& own = *owned_;
  const int ns = own.problem.dynamics->num_states();
  const int nf = own.layout.num_free();
  const size_t free_block = HasGap() ? 2 : 1;
  const bool derive = jacobians != nullptr;
  const bool by_free = derive && jacobians[free_block] != nullptr;
  const SegmentColumns columns =
      by_free ? SegmentColumns::kAll : SegmentColumns::kStart;
  Vector all = own.layout.InitialValues();
  own.layout.SetFree(Eigen::Map<const Vector>(parameters[free_block], nf),
                     &all);
  StructuralDynamics::Prepared prepared;
  own.rows.Prepare(own.data, own.sigmas, own.IsWhole(), ns, columns,
                   &own.tangents);
  std::string error;
  if (!all.allFinite() ||
      !own.problem.dynamics->Prepare(all.head(own.layout.num_dynamics()),
                                     &prepared, &error) ||
      !own.propagator.Propagate(prepared, own.observation, own.grid,
                                Eigen::Map<const Vector>(parameters[0], ns),
                                own.first, own.last, !HasGap(), columns,
                                &own.tangents)) {
    return false;
  }
  own.rows.Compute(own.data, own.sigmas, all, own.first, own.IsWhole(), columns,
                   &own.tangents);
  const auto weighted = own.rows.rows().residuals();
  const Eigen::Index count = weighted.size();
  Eigen::Map<Vector> r(residuals, num_residuals());
  r.head(count) = weighted;
  const Vector inverse = own.gap_sigmas.cwiseInverse();
  if (HasGap()) {
    r.tail(ns) = inverse.cwiseProduct(
        own.tangents.end_state - Eigen::Map<const Vector>(parameters[1], ns));
    AddSensorColumns(own.layout, ns, columns, own.tangents.end_sensitivity,
                     &own.end_sensitivity);
  }
  const auto fill = [&](size_t block, Eigen::Index column, int size) {
    if (!derive || jacobians[block] == nullptr) return;
    Eigen::Map<RowMajorMatrix> jacobian(jacobians[block], num_residuals(),
                                        size);
    jacobian.topRows(count) =
        own.rows.rows().jacobian().middleCols(column, size);
    if (HasGap()) {
      jacobian.bottomRows(ns) =
          inverse.asDiagonal() * own.end_sensitivity.middleCols(column, size);
    }
  };
  fill(0, 0, ns);
  fill(free_block, ns, nf);
  if (HasGap() && derive && jacobians[1] != nullptr) {
    Eigen::Map<RowMajorMatrix> jacobian(jacobians[1], num_residuals(), ns);
    jacobian.setZero();
    jacobian.bottomRows(ns).diagonal() = -inverse;
  }
  return r.allFinite();
}

}  // namespace pinode
