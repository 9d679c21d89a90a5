#include "pinode/estimate/ambient/ambient_lines.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

namespace pinode {
namespace {

// Ends of the band where the record gives none, relative to the model's lowest
// and highest frequency, and to half the sampling rate.
constexpr double kBelowLowest = 0.3;
constexpr double kAboveHighest = 1.5;
constexpr double kBelowNyquist = 0.8;
// Limits of the damping ratio by which lines are taken together: half that of
// the model's least damped mode, within these.
constexpr double kLeastDampingOfLines = 5e-4;
constexpr double kMostDampingOfLines = 0.01;
// Noise below this part of a channel's density makes no difference.
constexpr double kSmallestNoise = 1e-7;
// Room below the cost of neighbours' means; where measured loads are taken off,
// neighbours' combinations of them leave more than the model does.
constexpr double kRoom = 3.0;
constexpr double kRoomOfRest = 12.0;

// Number of neighbouring lines over which a mean says something.
Eigen::Index StretchOf(Eigen::Index channels, Eigen::Index inputs) {
  return 2 * channels + 8 + 2 * inputs;
}

// Lines minus the best combination of the inputs, stretch by stretch.
ComplexMatrix WithoutInputs(const ComplexMatrix& values,
                            const ComplexMatrix& inputs) {
  ComplexMatrix rest = values;
  const Eigen::Index stretch = StretchOf(values.rows(), inputs.rows());
  for (Eigen::Index first = 0; first < values.cols(); first += stretch) {
    const Eigen::Index count = std::min(stretch, values.cols() - first);
    const ComplexMatrix u = inputs.middleCols(first, count).adjoint();
    auto y = rest.middleCols(first, count);
    const ComplexMatrix right = y.adjoint();
    const ComplexMatrix solution = u.colPivHouseholderQr().solve(right);
    const ComplexMatrix part = u * solution;
    y -= part.adjoint();
  }
  return rest;
}

// The cost of a model as good as the means of neighbouring lines, and `room`
// below for each channel and line: what makes all costs positive.
double OffsetOf(const ComplexMatrix& lines, double tied, double room) {
  const Eigen::Index channels = lines.rows();
  const Eigen::Index stretch = StretchOf(channels, 0);
  double cost = 0.0;
  for (Eigen::Index first = 0; first < lines.cols(); first += stretch) {
    const Eigen::Index count = std::min(stretch, lines.cols() - first);
    const auto y = lines.middleCols(first, count);
    ComplexMatrix mean = y * y.adjoint() / static_cast<double>(count);
    mean.diagonal().array() += 1e-9 * mean.diagonal().real().mean() + 1e-300;
    const Eigen::LLT<ComplexMatrix> factor(mean);
    const Matrix diagonal = factor.matrixLLT().diagonal().real();
    cost += static_cast<double>(count) *
            (2.0 * diagonal.array().max(1e-300).log().sum() +
             static_cast<double>(channels));
  }
  return (room * static_cast<double>(channels * lines.cols()) - cost) / tied;
}

// Band of a record, chosen where the record gives none; `frequencies` are those
// of the model's modes.
void FindBand(const AmbientRecord& record, const Vector& frequencies,
              double* lowest, double* highest) {
  *lowest = record.lowest_frequency;
  *highest = record.highest_frequency;
  const double nyquist = 0.5 / record.sampling_step;
  const double ten_lines = 10.0 / (static_cast<double>(record.samples.cols()) *
                                   record.sampling_step);
  if (*lowest == 0.0) {
    *lowest = ten_lines;
    for (const double f : frequencies) {
      if (f > 0.0) {
        *lowest = std::max(ten_lines, kBelowLowest * f);
        break;
      }
    }
    *lowest = std::min(*lowest, 0.1 * nyquist);
  }
  if (*highest == 0.0) {
    *highest = kBelowNyquist * nyquist;
    if (frequencies.size() > 0 && frequencies.tail(1)[0] > 0.0) {
      *highest = std::min(*highest, kAboveHighest * frequencies.tail(1)[0]);
    }
    *highest = std::max(*highest, 2.0 * *lowest);
  }
}

}  // namespace
AmbientLines::AmbientLines(const AmbientRecord& record,
                           const StructuralDynamics& averaged,
                           const ModalProperties& modes,
                           const Matrix& measured_loads, int num_threads) {
  FindBand(record, modes.frequency_hz, &lowest_, &highest_);
  LineTransform transform(record.samples, record.sampling_step, lowest_,
                          highest_);
  SpectralLines lines = transform.Apply(record.samples);
  num_single_ = lines.frequency.size();
  const Eigen::Index channels = lines.values.rows();
  scales_.resize(channels);
  for (Eigen::Index c = 0; c < channels; ++c) {
    scales_[c] =
        std::sqrt(std::max(lines.values.row(c).squaredNorm() /
                               std::max(1.0, static_cast<double>(num_single_)),
                           1e-300));
    lines.values.row(c) /= scales_[c];
  }
  double ratio = kMostDampingOfLines;
  for (const double found : modes.damping_ratio) {
    if (found > 0.0) ratio = std::min(ratio, 0.5 * found);
  }
  groups_ = GroupLines(lines, 0.25 * std::max(ratio, kLeastDampingOfLines));
  smallest_noise_ = Vector::Constant(channels, kSmallestNoise);
  if (measured_loads.rows() == 0) {
    offset_ = OffsetOf(lines.values, lines.tied, kRoom);
    return;
  }
  const ComplexMatrix rest =
      WithoutInputs(lines.values, transform.Values(measured_loads));
  for (Eigen::Index c = 0; c < channels; ++c) {
    smallest_noise_[c] *= std::clamp(
        rest.row(c).squaredNorm() / lines.values.row(c).squaredNorm(),
        kSmallestNoise, 1.0);
  }
  offset_ = OffsetOf(rest, lines.tied, kRoomOfRest);
  mean_ = std::make_unique<AmbientMean>(record, averaged, std::move(transform),
                                        scales_, num_threads);
}

bool AmbientLines::SetPoint(const Vector& free, std::string* error) {
  if (mean_ == nullptr) return true;
  if (!mean_->SetPoint(free, error)) return false;
  groups_.SetProducts(mean_->rest());
  return true;
}

bool AmbientLines::SetSlopes(const Vector& free, std::string* error) {
  return mean_ == nullptr || mean_->SetSlopes(free, error);
}

}  // namespace pinode
