#include "pinode/case/draft/first_mode.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"

namespace pinode {
namespace {

// Segments are a half of the record or shorter, and no longer than this.
constexpr double kLongestSegment = 40.0;  // s
constexpr Eigen::Index kSmallestSegment = 32;
// Part of the base's largest density that is added to it before dividing.
constexpr double kFloorOfBase = 1e-4;
// Height of a peak above the lower of the valleys beside it, as a factor of
// the density, and over the largest peak.
constexpr double kModeProminence = 4.0;
constexpr double kLowestModePeak = 0.1;
constexpr size_t kMostModePeaks = 6;
// Sensors that move less than this part of the most lively one have no clear
// sign, and neither have those whose phase is farther off than its cosine.
constexpr double kLeastMotion = 0.1;
constexpr double kLeastCosine = 0.7;
// The base is against all floors where the sine of their phase is above this.
constexpr double kLeastSine = 0.5;

using Complex = std::complex<double>;

// Spectra of the floors with a reference.
struct CrossSpectra {
  Vector hz;
  Eigen::MatrixXcd with_reference;  // floors x frequencies
  Matrix densities;                 // floors x frequencies
  Vector reference;
};

Vector WithoutMean(const Vector& samples) {
  const double mean = MeanOfPresent(samples);
  Vector values = samples.array() - mean;
  for (double& value : values) {
    if (std::isnan(value)) value = 0.0;
  }
  return values;
}

CrossSpectra EstimateCrossSpectra(const Matrix& floors, const Vector& reference,
                                  double step) {
  const Eigen::Index n = reference.size();
  CrossSpectra spectra;
  Eigen::Index size = kSmallestSegment;
  while (4 * size <= n &&
         2.0 * static_cast<double>(size) * step <= kLongestSegment) {
    size *= 2;
  }
  const Eigen::Index half = size / 2;
  Vector window(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    window[k] = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(k) /
                                     static_cast<double>(size));
  }
  spectra.hz.resize(half);
  for (Eigen::Index f = 0; f < half; ++f) {
    spectra.hz[f] =
        static_cast<double>(f + 1) / (static_cast<double>(size) * step);
  }
  spectra.with_reference = Eigen::MatrixXcd::Zero(floors.rows(), half);
  spectra.densities = Matrix::Zero(floors.rows(), half);
  spectra.reference = Vector::Zero(half);
  Matrix values(floors.rows() + 1, n);
  values.row(0) = WithoutMean(reference).transpose();
  for (Eigen::Index c = 0; c < floors.rows(); ++c) {
    values.row(c + 1) = WithoutMean(floors.row(c).transpose()).transpose();
  }
  Eigen::FFT<double> fft;
  Eigen::VectorXcd transform;
  for (Eigen::Index first = 0; first + size <= n; first += half) {
    Eigen::VectorXcd base;
    for (Eigen::Index c = 0; c < values.rows(); ++c) {
      const Vector segment =
          values.row(c).segment(first, size).transpose().cwiseProduct(window);
      fft.fwd(transform, segment);
      const Eigen::VectorXcd lines = transform.segment(1, half);
      if (c == 0) {
        base = lines;
        spectra.reference += lines.cwiseAbs2();
        continue;
      }
      spectra.densities.row(c - 1) += lines.cwiseAbs2().transpose();
      spectra.with_reference.row(c - 1) +=
          lines.cwiseProduct(base.conjugate()).transpose();
    }
  }
  return spectra;
}

// Returns the positions of the peaks, ascending.
std::vector<Eigen::Index> ModePeaks(const Vector& density) {
  const Eigen::Index n = density.size();
  std::vector<std::pair<double, Eigen::Index>> found;
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    if (density[i] < density[i - 1] || density[i] <= density[i + 1]) continue;
    double left = density[i];
    for (Eigen::Index j = i; j-- > 0 && density[j] <= density[i];) {
      left = std::min(left, density[j]);
    }
    double right = density[i];
    for (Eigen::Index j = i + 1; j < n && density[j] <= density[i]; ++j) {
      right = std::min(right, density[j]);
    }
    if (density[i] >= kModeProminence * std::max(left, right)) {
      found.emplace_back(density[i], i);
    }
  }
  std::sort(found.rbegin(), found.rend());
  std::vector<Eigen::Index> peaks;
  for (const auto& [height, place] : found) {
    if (peaks.size() < kMostModePeaks &&
        height >= kLowestModePeak * found[0].first) {
      peaks.push_back(place);
    }
  }
  std::sort(peaks.begin(), peaks.end());
  return peaks;
}

// Returns the top of the parabola through the logarithms of three lines.
double InterpolatedPeak(const Vector& hz, const Vector& density,
                        Eigen::Index place) {
  const double left = std::log(density[place - 1]);
  const double middle = std::log(density[place]);
  const double right = std::log(density[place + 1]);
  const double bend = left - 2.0 * middle + right;
  const double shift = bend < 0.0 ? 0.5 * (left - right) / bend : 0.0;
  return hz[place] + std::clamp(shift, -0.5, 0.5) * (hz[1] - hz[0]);
}

// Sets the signs from the complex motion of the channels at the first peak.
void FindSigns(const Eigen::VectorXcd& motion, bool has_base, FirstMode* mode) {
  const double largest = motion.cwiseAbs().maxCoeff();
  // The common phase, up to 180 degrees.
  const Complex common = std::sqrt(motion.cwiseProduct(motion).sum());
  if (largest <= 0.0 || std::abs(common) <= 0.0) return;
  const Complex direction = common / std::abs(common);
  std::vector<int> signs;
  int sum = 0;
  for (const Complex& value : motion) {
    const double along =
        std::real(value * std::conj(direction)) / std::abs(value);
    const bool clear = std::abs(value) >= kLeastMotion * largest &&
                       std::abs(along) >= kLeastCosine;
    signs.push_back(!clear ? 0 : along > 0.0 ? 1 : -1);
    sum += signs.back();
  }
  // Two against two says nothing.
  if (sum == 0) return;
  const int majority = sum > 0 ? 1 : -1;
  for (size_t c = 0; c < signs.size(); ++c) {
    mode->is_reversed[c] = signs[c] == -majority;
  }
  mode->is_base_reversed =
      has_base && majority * std::imag(direction) > kLeastSine;
}

}  // namespace

FirstMode FindFirstMode(const Matrix& floors, const Vector& base, double step) {
  FirstMode mode;
  mode.is_reversed.assign(static_cast<size_t>(floors.rows()), false);
  if (floors.rows() == 0 || floors.cols() < 2 * kSmallestSegment) return mode;
  const bool has_base = base.size() > 0;
  const Vector reference =
      has_base ? base : Vector(floors.row(floors.rows() - 1).transpose());
  Matrix relative = floors;
  if (has_base) relative.rowwise() -= base.transpose();
  const CrossSpectra spectra = EstimateCrossSpectra(relative, reference, step);
  Vector density;
  if (has_base) {
    const Vector below =
        spectra.reference.array() + kFloorOfBase * spectra.reference.maxCoeff();
    density = spectra.with_reference.cwiseAbs2().colwise().sum().transpose();
    density.array() /= below.array().square();
  } else {
    density = spectra.densities.colwise().sum().transpose();
  }
  if (!density.allFinite() || density.minCoeff() <= 0.0) return mode;
  const std::vector<Eigen::Index> peaks = ModePeaks(density);
  for (const Eigen::Index place : peaks) {
    mode.peaks.push_back(InterpolatedPeak(spectra.hz, density, place));
  }
  if (peaks.empty()) return mode;
  mode.hz = mode.peaks[0];
  // Three lines, as one may be beside the resonance, with another phase.
  Eigen::VectorXcd motion = Eigen::VectorXcd::Zero(floors.rows());
  for (Eigen::Index f = peaks[0] - 1; f <= peaks[0] + 1; ++f) {
    motion +=
        spectra.with_reference.col(f) / (has_base ? spectra.reference[f] : 1.0);
  }
  FindSigns(motion, has_base, &mode);
  return mode;
}

}  // namespace pinode
