#include "pinode/estimate/shooting/shooting_record.h"

#include <algorithm>
#include <limits>

#include "pinode/problem/record_grid.h"

namespace pinode {

ShootingRecord::ShootingRecord(const IdentificationProblem& problem, int index,
                               double start_precision)
    : index_(index),
      data_(&problem.records[static_cast<size_t>(index)]),
      num_states_(problem.dynamics->num_states()),
      start_precision_(start_precision),
      grid_(GridOf(*problem.dynamics, *data_)),
      observation_(*problem.dynamics, data_->Observations()),
      start_is_free_(data_->start == IdentificationRecord::Start::kFree),
      fixed_start_(data_->start == IdentificationRecord::Start::kKnown
                       ? data_->known_start
                       : Vector::Zero(num_states_)),
      sigmas_(Vector::Ones(static_cast<int>(data_->channels.size()))),
      gaps_(num_states_, 1) {
  for (const MeasuredChannel& channel : data_->channels) {
    measured_.push_back(StatisticsOfPresent(channel.values));
  }
}

Matrix ShootingRecord::Cut(
    Eigen::Index samples,
    const std::function<Vector(Eigen::Index sample)>& state_at) {
  const Eigen::Index last = data_->num_samples() - 1;
  const auto count = static_cast<int>(std::clamp<Eigen::Index>(
      samples <= 0 ? 1 : (last + samples / 2) / samples, 1,
      std::numeric_limits<int>::max() - 1));
  boundaries_.clear();
  for (int k = 0; k <= count; ++k) boundaries_.push_back(last * k / count);
  Matrix starts(num_states_, count);
  for (int k = 0; k < count; ++k) starts.col(k) = state_at(first_sample(k));
  if (!start_is_free_) starts.col(0) = fixed_start_;
  gaps_.ResetMultipliers(count);
  results_.segments.assign(static_cast<size_t>(count), SegmentResult());
  results_.ends = Matrix::Zero(num_states_, count);
  equations_ =
      std::make_unique<StartEquations>(*this, start_is_free_, start_precision_);
  return starts;
}

}  // namespace pinode
