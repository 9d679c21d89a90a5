#include "pinode/record/resample.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/record/prepare.h"

namespace pinode {
namespace {

constexpr double kNumZeros = 32.0;
constexpr double kCutoff = 0.92;
// Distance, in steps, at which a new sample counts as at the time of an old
// one.
constexpr double kSameInstant = 1e-9;

double Sinc(double x) {
  return std::abs(x) < 1e-8 ? 1.0 : std::sin(kPi * x) / (kPi * x);
}

// Blackman's window over |x| <= 1.
double Window(double x) {
  const double c = std::cos(kPi * x);
  return 0.42 + 0.5 * c + 0.08 * (2.0 * c * c - 1.0);
}

// Returns a sample of the history extended by odd reflection about its ends.
// Beyond the reflection the last value holds.
double Reflected(const Vector& values, std::ptrdiff_t i) {
  const std::ptrdiff_t last = values.size() - 1;
  if (i < 0) return 2.0 * values[0] - values[std::min(-i, last)];
  if (i > last) {
    return 2.0 * values[last] -
           values[std::max<std::ptrdiff_t>(2 * last - i, 0)];
  }
  return values[i];
}

// Weights of the old samples around a time. They depend on the time's fraction
// alone. At a whole ratio of the steps it is always the same, and the sines are
// taken once: at half of the rate this takes 3 % of the time that a sine for
// each sample took.
class Weights {
 public:
  explicit Weights(double bandwidth)
      : bandwidth_(bandwidth), reach_(kNumZeros / bandwidth) {}

  // Returns the mean of the samples around `t`, in old samples.
  double Mean(const Vector& values, double t) {
    const double whole = std::floor(t);
    SetFraction(t - whole);
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(whole) + offset_;
    const std::ptrdiff_t count = weights_.size();
    if (first >= 0 && first + count <= values.size()) {
      return weights_.dot(values.segment(first, count)) / sum_;
    }
    double weighted = 0.0;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      weighted += weights_[i] * Reflected(values, first + i);
    }
    return weighted / sum_;
  }

 private:
  void SetFraction(double fraction) {
    if (fraction == fraction_) return;
    fraction_ = fraction;
    offset_ = static_cast<std::ptrdiff_t>(std::ceil(fraction - reach_));
    const auto end = static_cast<std::ptrdiff_t>(std::floor(fraction + reach_));
    weights_.resize(end - offset_ + 1);
    for (std::ptrdiff_t i = offset_; i <= end; ++i) {
      const double distance = fraction - static_cast<double>(i);
      weights_[i - offset_] =
          Sinc(bandwidth_ * distance) * Window(distance / reach_);
    }
    sum_ = weights_.sum();
  }

  double bandwidth_;
  double reach_;
  double fraction_ = kNaN;
  std::ptrdiff_t offset_ = 0;  // of the first weight from the whole sample
  Vector weights_;
  double sum_ = 0.0;
};

}  // namespace

Vector Resample(const Vector& values, double step, double new_step) {
  CHECK_GT(step, 0.0);
  CHECK_GT(new_step, 0.0);
  CHECK_GT(values.size(), 1) << "at least two samples are needed";
  const std::ptrdiff_t last = values.size() - 1;
  const double ratio = new_step / step;
  if (std::abs(ratio - 1.0) * static_cast<double>(last) < kSameInstant) {
    return values;
  }
  const auto num_new = static_cast<Eigen::Index>(std::floor(
                           static_cast<double>(last) / ratio + kSameInstant)) +
                       1;
  // The whole history lies before the second new sample. No cutoff could keep
  // anything, and the sum below would not end.
  if (num_new == 1) return values.head(1);
  if (CountPresent(values) == 0) {
    // There are no samples to draw a line through.
    return Vector::Constant(num_new, std::numeric_limits<double>::quiet_NaN());
  }
  const Vector filled = FillMissing(values);
  // Zeros of the sinc are 1 / bandwidth old samples apart.
  const double bandwidth = ratio > 1.0 ? kCutoff / ratio : 1.0;
  Weights weights(bandwidth);
  Vector result(num_new);
  for (Eigen::Index k = 0; k < num_new; ++k) {
    // Time in old samples.
    const double t =
        std::min(static_cast<double>(k) * ratio, static_cast<double>(last));
    const double nearest = std::round(t);
    const bool on_sample = std::abs(t - nearest) < kSameInstant * (1.0 + t);
    const auto before =
        static_cast<std::ptrdiff_t>(on_sample ? nearest : std::floor(t));
    const std::ptrdiff_t after = on_sample ? before : before + 1;
    if (std::isnan(values[before]) || std::isnan(values[after])) {
      result[k] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    result[k] = weights.Mean(filled, t);
  }
  return result;
}

Record ResampleRecord(const Record& record, double new_step) {
  Record result = record;
  result.sampling_step = new_step;
  for (Channel& channel : result.channels) {
    channel.values = Resample(channel.values, record.sampling_step, new_step);
  }
  return result;
}

}  // namespace pinode
