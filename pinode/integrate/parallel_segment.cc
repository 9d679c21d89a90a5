#include "pinode/integrate/parallel_segment.h"

#include "pinode/base/parallel_for.h"
#include "pinode/integrate/free_run.h"

namespace pinode {
namespace {

// Shortest piece for which a thread pays off.
constexpr int kLeastSamples = 500;

SegmentColumns WithStart(SegmentColumns columns) {
  return HasParameters(columns) ? SegmentColumns::kAll : SegmentColumns::kStart;
}

}  // namespace

ParallelSegment::ParallelSegment(const StructuralDynamics& dynamics,
                                 DerivativeMethod method, int num_threads)
    : dynamics_(dynamics), method_(method) {
  for (int t = 0; t < num_threads; ++t) {
    pieces_.push_back(std::make_unique<Piece>(dynamics, method));
  }
}

bool ParallelSegment::IsWorthwhile(const IntegrationGrid& grid,
                                   Eigen::Index first, Eigen::Index last,
                                   SegmentColumns columns) const {
  // Cost of a linearisation in columns, and cost of a state alone as a share of
  // it.
  constexpr double kLinearization = 10.0;
  constexpr double kStates = 0.2;
  constexpr double kLeastGain = 1.2;
  const int threads = static_cast<int>(pieces_.size());
  if (threads < 2 || columns == SegmentColumns::kNone ||
      method_ != DerivativeMethod::kTangents ||
      grid.integrator() == Integrator::kExact ||
      LinearSegment::Suits(dynamics_, grid.substeps()) ||
      last - first < Eigen::Index{threads} * kLeastSamples) {
    return false;
  }
  const double by_parameters =
      HasParameters(columns) ? dynamics_.num_tangent_columns() : 0.0;
  const double by_start = dynamics_.num_states();
  const double alone =
      kLinearization + by_parameters + (HasStart(columns) ? by_start : 0.0);
  const double together = kStates * kLinearization +
                          (kLinearization + by_parameters + by_start) / threads;
  return alone > kLeastGain * together;
}

bool ParallelSegment::Propagate(const StructuralDynamics::Prepared& prepared,
                                const ObservationMap& observation,
                                const IntegrationGrid& grid,
                                const Vector& start, Eigen::Index first,
                                Eigen::Index last, bool observe_last,
                                SegmentColumns columns,
                                SegmentTangents* result) {
  Trajectory states;
  if (!FreeRun(dynamics_, prepared, observation, grid, start, first, last,
               &states)) {
    result->failed_sample = states.failed_sample;
    result->failed_state = states.failed_state;
    return false;
  }
  const int count = static_cast<int>(pieces_.size());
  const auto boundary = [&](int p) {
    return first + (last - first) * p / count;
  };
  ParallelFor(count, count, [&](int p, int /*thread*/) {
    Piece& piece = *pieces_[static_cast<size_t>(p)];
    piece.first = boundary(p);
    piece.last = boundary(p + 1);
    piece.ok = piece.propagator.Propagate(
        prepared, observation, grid,
        p == 0 ? start : Vector(states.states.col(piece.first - first)),
        piece.first, piece.last, observe_last && p + 1 == count,
        p == 0 ? columns : WithStart(columns), &piece.tangents);
  });
  for (const auto& piece : pieces_) {
    if (piece->ok) continue;
    result->failed_sample = piece->tangents.failed_sample;
    result->failed_state = piece->tangents.failed_state;
    return false;
  }
  Chain(observation, first, last - first + (observe_last ? 1 : 0), columns,
        result);
  return true;
}

void ParallelSegment::Chain(const ObservationMap& observation,
                            Eigen::Index first, Eigen::Index samples,
                            SegmentColumns columns, SegmentTangents* result) {
  const int ns = dynamics_.num_states();
  const int nc = observation.num_channels();
  const SegmentTangents& beginning = pieces_.front()->tangents;
  const Eigen::Index by_parameters =
      HasParameters(columns) ? dynamics_.num_tangent_columns() : 0;
  // Derivatives of the start of each piece, with respect to the same quantities
  // as the segment's derivatives.
  std::vector<Matrix> starts = {Matrix(), beginning.end_sensitivity};
  for (size_t p = 1; p < pieces_.size(); ++p) {
    const Matrix& own = pieces_[p]->tangents.end_sensitivity;
    Matrix end = own.leftCols(ns) * starts[p];
    end.rightCols(by_parameters) += own.rightCols(by_parameters);
    starts.push_back(std::move(end));
  }
  result->failed_sample = -1;
  result->failed_state = -1;
  result->end_state = pieces_.back()->tangents.end_state;
  result->end_sensitivity = starts.back();
  result->channels.resize(nc, samples);
  result->ResizeJacobian(nc * samples, beginning.jacobian().cols());
  const int count = static_cast<int>(pieces_.size());
  ParallelFor(count, count, [&](int p, int /*thread*/) {
    const Piece& piece = *pieces_[static_cast<size_t>(p)];
    const SegmentTangents& own = piece.tangents;
    result->channels.middleCols(piece.first - first, own.channels.cols()) =
        own.channels;
    const auto jacobian = own.jacobian();
    auto rows = result->jacobian().middleRows((piece.first - first) * nc,
                                              jacobian.rows());
    if (p == 0) {
      rows = jacobian;
      return;
    }
    rows.noalias() = jacobian.leftCols(ns) * starts[static_cast<size_t>(p)];
    rows.rightCols(by_parameters) += jacobian.rightCols(by_parameters);
  });
  result->ApplyFactors();
}

}  // namespace pinode
