#include "pinode/record/short_gaps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/statistics.h"
#include "pinode/record/prepare.h"

namespace pinode {
namespace {

bool IsPresent(const Vector& values, Eigen::Index i) {
  return i >= 0 && i < values.size() && !std::isnan(values[i]);
}

// A gap is interpolated from two samples on each side of it.
bool HasNeighbours(const Vector& values, Eigen::Index first,
                   Eigen::Index size) {
  return IsPresent(values, first - 2) && IsPresent(values, first - 1) &&
         IsPresent(values, first + size) && IsPresent(values, first + size + 1);
}

// Returns the value of the cubic through the neighbours at sample first + k.
double Cubic(const Vector& values, Eigen::Index first, Eigen::Index size,
             Eigen::Index k) {
  const std::array<Eigen::Index, 4> at = {-2, -1, size, size + 1};
  double sum = 0.0;
  for (const Eigen::Index i : at) {
    double weight = 1.0;
    for (const Eigen::Index j : at) {
      if (j != i)
        weight *= static_cast<double>(k - j) / static_cast<double>(i - j);
    }
    sum += weight * values[first + i];
  }
  return sum;
}

// Returns the mean square error of the interpolation of gaps of `size` samples,
// tried on all stretches without gaps; NaN if there are none.
double MeanSquareError(const Vector& values, Eigen::Index size) {
  double sum = 0.0;
  Eigen::Index count = 0;
  Eigen::Index present = 0;  // samples before i + 1 without a gap
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    present = std::isnan(values[i]) ? 0 : present + 1;
    if (present < size + 4) continue;
    const Eigen::Index first = i - size - 1;
    for (Eigen::Index k = 0; k < size; ++k) {
      const double error = Cubic(values, first, size, k) - values[first + k];
      sum += error * error;
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : kNaN;
}

double Variance(const Vector& values) {
  const double deviation = StandardDeviationOfPresent(values);
  return deviation * deviation;
}

}  // namespace

ShortGaps FillShortGaps(Vector* values) {
  CHECK(values != nullptr);
  const Vector before = *values;
  ShortGaps filled;
  double error = 0.0;  // sum of squares
  std::array<double, kMostShortGap> errors;
  errors.fill(-1.0);
  for (const Gap& gap : FindGaps(before)) {
    if (gap.size > kMostShortGap ||
        !HasNeighbours(before, gap.first, gap.size)) {
      continue;
    }
    double& one = errors[static_cast<size_t>(gap.size - 1)];
    if (one < 0.0) one = MeanSquareError(before, gap.size);
    error += one * static_cast<double>(gap.size);
    for (Eigen::Index k = 0; k < gap.size; ++k) {
      (*values)[gap.first + k] = Cubic(before, gap.first, gap.size, k);
    }
    filled.num_samples += gap.size;
    filled.longest = std::max<Eigen::Index>(filled.longest, gap.size);
  }
  if (filled.num_samples > 0) {
    filled.error = std::sqrt(error / static_cast<double>(values->size()) /
                             Variance(before));
  }
  return filled;
}

}  // namespace pinode
