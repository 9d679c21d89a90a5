#include "pinode/record/excitation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/record/prepare.h"

namespace pinode {
namespace {

// Samples on either side that take part.
constexpr int kHalfWidth = 32;
// Parameter of the Kaiser window for an attenuation of 100 dB (J. F. Kaiser and
// R. W. Schafer, IEEE Trans. ASSP 28 (1980) 105-107).
constexpr double kKaiser = 10.06;

using SincWeights = std::array<double, 2 * kHalfWidth>;

SincWeights MakeSincWeights(double fraction) {
  SincWeights weights;
  double sum = 0.0;
  for (int k = 0; k < 2 * kHalfWidth; ++k) {
    const double u = fraction - (k - kHalfWidth + 1);
    const double edge = u / kHalfWidth;
    const double window = std::cyl_bessel_i(
        0.0, kKaiser * std::sqrt(std::max(0.0, 1.0 - edge * edge)));
    weights[static_cast<size_t>(k)] =
        window * (u == 0.0 ? 1.0 : std::sin(kPi * u) / (kPi * u));
    sum += weights[static_cast<size_t>(k)];
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

// Callers that build tables ask for one fraction after the other.
const SincWeights& SincWeightsAt(double fraction) {
  thread_local double last = -1.0;
  thread_local SincWeights weights;
  if (fraction != last) {
    weights = MakeSincWeights(fraction);
    last = fraction;
  }
  return weights;
}

}  // namespace

const char* InterpolationName(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::kHeld:
      return "held";
    case Interpolation::kLinear:
      return "linear";
    case Interpolation::kCubic:
      return "cubic";
    case Interpolation::kBandLimited:
      return "band_limited";
  }
  LOG(FATAL) << "not an interpolation: " << static_cast<int>(interpolation);
  return "";
}

bool ParseInterpolation(const std::string& name, Interpolation* interpolation) {
  CHECK(interpolation != nullptr);
  for (const Interpolation candidate :
       {Interpolation::kHeld, Interpolation::kLinear, Interpolation::kCubic,
        Interpolation::kBandLimited}) {
    if (name == InterpolationName(candidate)) {
      *interpolation = candidate;
      return true;
    }
  }
  return false;
}

Excitation::Excitation(double start_time, double step, Matrix samples,
                       Interpolation interpolation, bool periodic)
    : start_time_(start_time),
      step_(step),
      samples_(std::make_shared<const Matrix>(std::move(samples))),
      interpolation_(interpolation),
      periodic_(periodic) {}

int Excitation::reach() const {
  switch (interpolation_) {
    case Interpolation::kHeld:
    case Interpolation::kLinear:
      return 1;
    case Interpolation::kCubic:
      return 2;
    case Interpolation::kBandLimited:
      return kHalfWidth;
  }
  LOG(FATAL) << "not an interpolation: " << static_cast<int>(interpolation_);
  return 0;
}

template <typename Target>
void Excitation::AddSample(Eigen::Index sample, double weight,
                           Target* result) const {
  const Eigen::Index count = samples_->cols();
  const Eigen::Index last = count - 1;
  if (periodic_) {
    *result += weight * samples_->col(((sample % count) + count) % count);
  } else if (interpolation_ != Interpolation::kBandLimited) {
    *result +=
        weight * samples_->col(std::clamp<Eigen::Index>(sample, 0, last));
  } else if (sample < 0) {
    *result += weight * (2.0 * samples_->col(0) -
                         samples_->col(std::min(-sample, last)));
  } else if (sample > last) {
    *result +=
        weight * (2.0 * samples_->col(last) -
                  samples_->col(std::max<Eigen::Index>(2 * last - sample, 0)));
  } else {
    *result += weight * samples_->col(sample);
  }
}

void Excitation::Evaluate(Eigen::Index interval, double fraction,
                          double* inputs) const {
  DCHECK_GE(interval, 0);
  DCHECK_GE(fraction, 0.0);
  DCHECK_LE(fraction, 1.0);
  const Eigen::Index last = samples_->cols() - 1;
  const Eigen::Index i = interval;
  const double x = i < last || periodic_ ? fraction : 0.0;
  Eigen::Map<Vector> result(inputs, samples_->rows());
  result.setZero();
  if (x == 0.0 || interpolation_ == Interpolation::kHeld) {
    // Not AddSample(i): behind the end the last value holds.
    result = samples_->col(periodic_ ? i % (last + 1) : std::min(i, last));
    return;
  }
  switch (interpolation_) {
    case Interpolation::kHeld:
      break;
    case Interpolation::kLinear:
      AddSample(i, 1.0 - x, &result);
      AddSample(i + 1, x, &result);
      break;
    case Interpolation::kCubic:
      // Catmull-Rom in the form of weights, which add up to one.
      AddSample(i - 1, 0.5 * x * (-1.0 + x * (2.0 - x)), &result);
      AddSample(i, 1.0 + 0.5 * x * x * (-5.0 + 3.0 * x), &result);
      AddSample(i + 1, 0.5 * x * (1.0 + x * (4.0 - 3.0 * x)), &result);
      AddSample(i + 2, 0.5 * x * x * (-1.0 + x), &result);
      break;
    case Interpolation::kBandLimited:
      if (x == 1.0) {
        AddSample(i + 1, 1.0, &result);
        break;
      }
      const SincWeights& weights = SincWeightsAt(x);
      const Eigen::Index first = i - kHalfWidth + 1;
      if (first >= 0 && first + 2 * kHalfWidth <= samples_->cols()) {
        result.noalias() =
            samples_->middleCols<2 * kHalfWidth>(first) *
            Eigen::Map<const Eigen::Matrix<double, 2 * kHalfWidth, 1>>(
                weights.data());
        break;
      }
      for (int k = 0; k < 2 * kHalfWidth; ++k) {
        AddSample(i + k - kHalfWidth + 1, weights[static_cast<size_t>(k)],
                  &result);
      }
      break;
  }
}

bool IsCompleteExcitation(const Record& record, const Channel& channel,
                          std::string* error) {
  CHECK(error != nullptr);
  const std::vector<Gap> gaps = FindGaps(channel.values);
  if (gaps.empty()) return true;
  const Gap& gap = gaps.front();
  *error =
      "record '" + record.name + "': the excitation '" + channel.name +
      "' misses " + std::to_string(gap.size) +
      (gap.size == 1 ? " sample" : " samples") + " from " +
      FormatNumber(record.time(gap.first), 10) + " to " +
      FormatNumber(record.time(gap.first + gap.size - 1), 10) +
      (gaps.size() > 1 ? " (and more in " + std::to_string(gaps.size() - 1) +
                             " further gaps)"
                       : "");
  return false;
}

}  // namespace pinode
