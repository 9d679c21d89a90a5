#include "pinode/integrate/linear_segment.h"

#include <algorithm>
#include <cmath>

#include "pinode/integrate/segment.h"

namespace pinode {
namespace {

// Largest tables of derivatives, in numbers: 256 MiB.
constexpr double kLargestTable = 32.0 * 1024.0 * 1024.0;
// Number of samples whose forcing is one matrix product.
constexpr Eigen::Index kBlock = 64;

using Inputs = Eigen::Map<const Matrix>;

}  // namespace

bool LinearSegment::Suits(const StructuralDynamics& dynamics, int substeps) {
  return dynamics.IsLinear() &&
         LinearMap::TableSize(dynamics, substeps) <= kLargestTable;
}

void LinearSegment::UpdateMap(const StructuralDynamics::Prepared& prepared,
                              const IntegrationGrid& grid,
                              bool with_parameters) {
  if (map_.has_value() && step_ == grid.step() &&
      substeps_ == grid.substeps() && integrator_ == grid.integrator() &&
      theta_ == prepared.theta && (has_parameters_ || !with_parameters)) {
    return;
  }
  map_.emplace(dynamics_, prepared, grid, with_parameters);
  theta_ = prepared.theta;
  step_ = grid.step();
  substeps_ = grid.substeps();
  integrator_ = grid.integrator();
  has_parameters_ = with_parameters;
}

bool LinearSegment::Run(const IntegrationGrid& grid, const Vector& start,
                        Eigen::Index first, Eigen::Index last,
                        SegmentTangents* result) {
  const int ns = dynamics_.num_states();
  states_.resize(ns, last - first + 1);
  states_.col(0) = start;
  for (Eigen::Index begin = first; begin < last; begin += kBlock) {
    const Eigen::Index count = std::min(kBlock, last - begin);
    grid.GetNodes(begin, count, &nodes_);
    states_.middleCols(begin - first + 1, count).noalias() =
        map_->forcing() * nodes_;
  }
  for (Eigen::Index i = 0; i <= last - first; ++i) {
    if (i > 0) {
      states_.col(i).noalias() += map_->transition() * states_.col(i - 1);
    }
    result->failed_state = FirstNotFinite(states_.col(i));
    if (result->failed_state >= 0) {
      result->failed_sample = first + i;
      return false;
    }
  }
  return true;
}

void LinearSegment::UpdateForcing(const IntegrationGrid& grid,
                                  Eigen::Index first, Eigen::Index begin,
                                  Eigen::Index count) {
  const int ns = dynamics_.num_states();
  const Matrix& table = map_->derivatives();
  forcing_.resize(table.rows(), count);
  forcing_.noalias() =
      table.leftCols(ns) * states_.middleCols(begin - first, count);
  if (table.cols() == ns) return;
  grid.GetNodes(begin, count, &nodes_);
  forcing_.noalias() += table.rightCols(table.cols() - ns) * nodes_;
}

void LinearSegment::UpdateDirect(const ObservationMap& observation,
                                 const IntegrationGrid& grid,
                                 Eigen::Index first, Eigen::Index samples) {
  const int ns = dynamics_.num_states();
  const int ni = dynamics_.num_inputs();
  const Matrix& left = observation.rate_map();
  const auto& derivatives = map_->rate_derivatives();
  Matrix table(left.rows() * static_cast<Eigen::Index>(derivatives.size()),
               ns + ni);
  for (size_t j = 0; j < derivatives.size(); ++j) {
    table.middleRows(static_cast<Eigen::Index>(j) * left.rows(), left.rows())
        .noalias() = left * derivatives[j];
  }
  direct_.resize(table.rows(), samples);
  direct_.noalias() = table.leftCols(ns) * states_.leftCols(samples);
  direct_.noalias() +=
      table.rightCols(ni) * Inputs(grid.AtSample(first), ni, samples);
}

bool LinearSegment::Propagate(const StructuralDynamics::Prepared& prepared,
                              const ObservationMap& observation,
                              const IntegrationGrid& grid, const Vector& start,
                              Eigen::Index first, Eigen::Index last,
                              bool observe_last, SegmentColumns columns,
                              SegmentTangents* result) {
  const int ns = dynamics_.num_states();
  const int ni = dynamics_.num_inputs();
  const bool with_parameters = HasParameters(columns);
  const int np = with_parameters ? dynamics_.num_tangent_columns() : 0;
  const int by_start = HasStart(columns) ? ns : 0;
  const int channels = observation.num_channels();
  const Eigen::Index samples = last - first + (observe_last ? 1 : 0);
  UpdateMap(prepared, grid, with_parameters);
  result->failed_sample = -1;
  if (!Run(grid, start, first, last, result)) return false;

  result->channels.resize(channels, samples);
  Matrix rates = map_->rate().leftCols(ns) * states_.leftCols(samples);
  rates.noalias() +=
      map_->rate().rightCols(ni) * Inputs(grid.AtSample(first), ni, samples);
  for (Eigen::Index i = 0; i < samples; ++i) {
    observation.Observe(states_.col(i).data(), rates.col(i).data(),
                        grid.AtSample(first + i),
                        result->channels.col(i).data());
  }
  const std::vector<int>& rows = observation.acceleration_rows();
  const int num_rows = static_cast<int>(rows.size());
  if (np > 0 && num_rows > 0) UpdateDirect(observation, grid, first, samples);

  auto at = dynamics_.MakeLinearization();
  dynamics_.Linearize(prepared, grid.time(first), grid.AtSample(first),
                      start.data(), &at);
  Matrix state_jacobian;
  observation.StateJacobian(at, &state_jacobian);

  result->ResizeJacobian(channels * samples, by_start + np);
  auto jacobian = result->jacobian();
  sensitivity_ = Matrix::Zero(ns, by_start + np);
  sensitivity_.leftCols(by_start).setIdentity();
  next_.resize(ns, by_start + np);
  for (Eigen::Index begin = first; begin <= last; begin += kBlock) {
    // The last sample has no interval.
    const Eigen::Index count = std::min(kBlock, last - begin);
    if (np > 0 && count > 0) UpdateForcing(grid, first, begin, count);
    for (Eigen::Index i = begin; i <= std::min(begin + kBlock - 1, last); ++i) {
      if (i - first < samples) {
        const Eigen::Index row = (i - first) * channels;
        jacobian.middleRows(row, channels).noalias() =
            state_jacobian * sensitivity_;
        for (int r = 0; r < (np > 0 ? num_rows : 0); ++r) {
          for (int j = 0; j < np; ++j) {
            jacobian(row + rows[static_cast<size_t>(r)], by_start + j) +=
                direct_(j * num_rows + r, i - first);
          }
        }
      }
      if (i == last) break;
      next_.noalias() = map_->transition() * sensitivity_;
      if (np > 0) {
        next_.rightCols(np) +=
            Eigen::Map<const Matrix>(forcing_.col(i - begin).data(), ns, np);
      }
      sensitivity_.swap(next_);
    }
  }
  result->ApplyFactors();
  result->end_state = states_.col(last - first);
  result->end_sensitivity = sensitivity_;
  return true;
}

}  // namespace pinode
