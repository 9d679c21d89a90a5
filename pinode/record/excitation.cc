#include "pinode/record/excitation.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/record/prepare.h"

namespace pinode {

const char* InterpolationName(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::kHeld:
      return "held";
    case Interpolation::kLinear:
      return "linear";
    case Interpolation::kCubic:
      return "cubic";
  }
  LOG(FATAL) << "not an interpolation: " << static_cast<int>(interpolation);
  return "";
}

bool ParseInterpolation(const std::string& name, Interpolation* interpolation) {
  CHECK(interpolation != nullptr);
  for (const Interpolation candidate :
       {Interpolation::kHeld, Interpolation::kLinear, Interpolation::kCubic}) {
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
