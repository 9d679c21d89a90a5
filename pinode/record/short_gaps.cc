#include "pinode/record/short_gaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

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

// Mean square errors of the interpolation of gaps of one size, tried on all
// stretches without gaps.
class Trials {
 public:
  Trials(const Vector& values, Eigen::Index size)
      : errors_(Vector::Zero(values.size() + 1)),
        counts_(Vector::Zero(values.size() + 1)) {
    Eigen::Index present = 0;  // samples up to i without a gap
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      present = std::isnan(values[i]) ? 0 : present + 1;
      errors_[i + 1] = errors_[i];
      counts_[i + 1] = counts_[i];
      if (present < size + 4) continue;
      const Eigen::Index first = i - size - 1;
      for (Eigen::Index k = 0; k < size; ++k) {
        const double error = Cubic(values, first, size, k) - values[first + k];
        errors_[i + 1] += error * error;
      }
      counts_[i + 1] += static_cast<double>(size);
    }
  }

  // Returns the error near a sample, for a load is quiet at one time and strong
  // at another. If nothing can be tried there: that of the whole signal; NaN if
  // it has no complete stretch.
  double MeanSquareError(Eigen::Index sample) const {
    constexpr Eigen::Index kAround = 50;
    const Eigen::Index last = errors_.size() - 1;
    const Eigen::Index from = std::max<Eigen::Index>(0, sample - kAround);
    const Eigen::Index to = std::min(last, sample + kAround);
    const double count = counts_[to] - counts_[from];
    if (count > 0.0) {
      return std::max(0.0, errors_[to] - errors_[from]) / count;
    }
    return counts_[last] > 0.0 ? errors_[last] / counts_[last] : kNaN;
  }

 private:
  Vector errors_, counts_;  // sums over the trials that end before a sample
};

// Returns the variance; that of rounding, at least, for a constant signal.
double Variance(const Vector& values) {
  const double deviation = StandardDeviationOfPresent(values);
  const double rounding =
      1e-12 * values.cwiseAbs().maxCoeff<Eigen::PropagateNumbers>();
  return deviation * deviation + rounding * rounding;
}

}  // namespace

ShortGaps FillShortGaps(Vector* values) {
  CHECK(values != nullptr);
  const Vector before = *values;
  ShortGaps filled;
  double error = 0.0;  // sum of squares
  std::array<std::optional<Trials>, kMostShortGap> trials;
  for (const Gap& gap : FindGaps(before)) {
    if (gap.size > kMostShortGap ||
        !HasNeighbours(before, gap.first, gap.size)) {
      continue;
    }
    std::optional<Trials>& tried = trials[static_cast<size_t>(gap.size - 1)];
    if (!tried.has_value()) tried.emplace(before, gap.size);
    error += tried->MeanSquareError(gap.first) * static_cast<double>(gap.size);
    for (Eigen::Index k = 0; k < gap.size; ++k) {
      (*values)[gap.first + k] = Cubic(before, gap.first, gap.size, k);
    }
    filled.num_samples += gap.size;
    filled.longest = std::max<Eigen::Index>(filled.longest, gap.size);
  }
  // Zero stays zero.
  filled.error = error;
  if (error > 0.0) {
    filled.error = std::sqrt(error / static_cast<double>(values->size()) /
                             Variance(before));
  }
  return filled;
}

}  // namespace pinode
