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
// Of the Kaiser window, for an attenuation of 100 dB (J. F. Kaiser and R. W.
// Schafer, IEEE Trans. ASSP 28 (1980) 105-107).
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

// Those who tabulate ask for one fraction after the other.
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
                       Interpolation interpolation)
    : start_time_(start_time),
      step_(step),
      samples_(std::move(samples)),
      interpolation_(interpolation) {}

void Excitation::Evaluate(int interval, double fraction, double* inputs) const {
  DCHECK_GE(interval, 0);
  DCHECK_GE(fraction, 0.0);
  DCHECK_LE(fraction, 1.0);
  const Eigen::Index last = samples_.cols() - 1;
  const Eigen::Index i = std::min<Eigen::Index>(interval, last);
  Eigen::Map<Vector> result(inputs, samples_.rows());
  if (i == last || interpolation_ == Interpolation::kHeld) {
    result = samples_.col(i);
    return;
  }
  const double x = fraction;
  if (interpolation_ == Interpolation::kLinear) {
    result = (1.0 - x) * samples_.col(i) + x * samples_.col(i + 1);
    return;
  }
  if (interpolation_ == Interpolation::kBandLimited) {
    if (x == 0.0 || x == 1.0) {
      result = samples_.col(x == 0.0 ? i : i + 1);
      return;
    }
    const SincWeights& weights = SincWeightsAt(x);
    result.setZero();
    for (int k = 0; k < 2 * kHalfWidth; ++k) {
      const double weight = weights[static_cast<size_t>(k)];
      const Eigen::Index at = i + k - kHalfWidth + 1;
      // Beyond the ends the samples go on mirrored at the end point.
      if (at < 0) {
        result += weight *
                  (2.0 * samples_.col(0) - samples_.col(std::min(-at, last)));
      } else if (at > last) {
        result +=
            weight * (2.0 * samples_.col(last) -
                      samples_.col(std::max<Eigen::Index>(2 * last - at, 0)));
      } else {
        result += weight * samples_.col(at);
      }
    }
    return;
  }
  // Catmull-Rom in the form of weights, which add up to one.
  const double before = 0.5 * x * (-1.0 + x * (2.0 - x));
  const double left = 1.0 + 0.5 * x * x * (-5.0 + 3.0 * x);
  const double right = 0.5 * x * (1.0 + x * (4.0 - 3.0 * x));
  const double after = 0.5 * x * x * (-1.0 + x);
  result = before * samples_.col(std::max<Eigen::Index>(i - 1, 0)) +
           left * samples_.col(i) + right * samples_.col(i + 1) +
           after * samples_.col(std::min(i + 2, last));
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
                       : "") +
      ", expected one without gaps; choose a window without them";
  return false;
}

}  // namespace pinode
