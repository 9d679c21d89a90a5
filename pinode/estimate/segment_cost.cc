#include "pinode/estimate/segment_cost.h"

#include <limits>
#include <sstream>
#include <vector>

#include "pinode/estimate/start/initial_states.h"
#include "pinode/problem/assumed_noise.h"
#include "pinode/problem/record_grid.h"

namespace pinode {
namespace {

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Share of a state's size within which gaps are closed.
constexpr double kGapShare = 1e-3;

bool ArePositive(const Vector& values, Eigen::Index count) {
  return values.size() == count && values.allFinite() &&
         (values.array() > 0.0).all();
}

// At most: of all samples, and of the gap behind them.
Eigen::Index NumResiduals(Eigen::Index intervals, Eigen::Index channels,
                          Eigen::Index states) {
  return (intervals + 1) * channels + states;
}

bool IsValidSegment(const IdentificationProblem& problem, int record,
                    Eigen::Index first, Eigen::Index last,
                    const SegmentCost::Options& options, std::string* error) {
  std::ostringstream message;
  const int num_records = static_cast<int>(problem.records.size());
  if (record < 0 || record >= num_records) {
    message << "there is no record " << record << " among " << num_records;
    *error = message.str();
    return false;
  }
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
  return std::unique_ptr<SegmentCost>(
      new SegmentCost(problem, record, first, last, complete));
}

SegmentCost::SegmentCost(const IdentificationProblem& problem, int record,
                         Eigen::Index first, Eigen::Index last,
                         const Options& options)
    : problem_(problem),
      data_(problem.records[static_cast<size_t>(record)]),
      layout_(problem),
      first_(first),
      last_(last),
      sigmas_(options.sigmas),
      gap_sigmas_(options.gap_sigmas),
      grid_(GridOf(*problem.dynamics, data_)),
      observation_(*problem.dynamics, data_.Observations()),
      propagator_(*problem.dynamics, options.derivatives),
      rows_(layout_, RobustLoss::kNone, 1.0) {
  const int ns = problem.dynamics->num_states();
  const Eigen::Index observed = last - first + (HasGap() ? 0 : 1);
  set_num_residuals(static_cast<int>(observed) * observation_.num_channels() +
                    (HasGap() ? ns : 0));
  mutable_parameter_block_sizes()->push_back(ns);
  if (HasGap()) mutable_parameter_block_sizes()->push_back(ns);
  mutable_parameter_block_sizes()->push_back(layout_.num_free());
}

bool SegmentCost::Evaluate(double const* const* parameters, double* residuals,
                           double** jacobians) const {
  const int ns = problem_.dynamics->num_states();
  const int nf = layout_.num_free();
  const size_t free_block = HasGap() ? 2 : 1;
  const bool derive = jacobians != nullptr;
  const bool by_free = derive && jacobians[free_block] != nullptr;
  const SegmentColumns columns =
      by_free ? SegmentColumns::kAll : SegmentColumns::kStart;
  Vector all = layout_.InitialValues();
  layout_.SetFree(Eigen::Map<const Vector>(parameters[free_block], nf), &all);
  StructuralDynamics::Prepared prepared;
  rows_.Prepare(data_, sigmas_, IsWhole(), ns, columns, &tangents_);
  std::string error;
  if (!all.allFinite() ||
      !problem_.dynamics->Prepare(all.head(layout_.num_dynamics()), &prepared,
                                  &error) ||
      !propagator_.Propagate(prepared, observation_, grid_,
                             Eigen::Map<const Vector>(parameters[0], ns),
                             first_, last_, !HasGap(), columns, &tangents_)) {
    return false;
  }
  rows_.Compute(data_, sigmas_, all, first_, IsWhole(), columns, &tangents_);
  const auto weighted = rows_.rows().residuals();
  const Eigen::Index count = weighted.size();
  Eigen::Map<Vector> r(residuals, num_residuals());
  r.head(count) = weighted;
  const Vector inverse = gap_sigmas_.cwiseInverse();
  if (HasGap()) {
    r.tail(ns) = inverse.cwiseProduct(
        tangents_.end_state - Eigen::Map<const Vector>(parameters[1], ns));
    AddSensorColumns(layout_, ns, columns, tangents_.end_sensitivity,
                     &end_sensitivity_);
  }
  const auto fill = [&](size_t block, Eigen::Index column, int size) {
    if (!derive || jacobians[block] == nullptr) return;
    Eigen::Map<RowMajorMatrix> jacobian(jacobians[block], num_residuals(),
                                        size);
    jacobian.topRows(count) = rows_.rows().jacobian().middleCols(column, size);
    if (HasGap()) {
      jacobian.bottomRows(ns) =
          inverse.asDiagonal() * end_sensitivity_.middleCols(column, size);
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
