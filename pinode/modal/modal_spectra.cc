#include "pinode/modal/modal_spectra.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "pinode/base/constants.h"
#include "pinode/modal/spectra.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

constexpr int kReweightings = 4;
// Lines on either side over which the first weights are averaged.
constexpr Eigen::Index kNeighbours = 4;
// Smallest model value in the weights, as a share of the measured one.
constexpr double kLeastShare = 0.1;

// Returns the correlation of Hann's window with itself at lags of 0 to size - 1
// samples, 1 at 0.
Vector WindowCorrelation(Eigen::Index size) {
  Eigen::VectorXcd window = Eigen::VectorXcd::Zero(2 * size);
  for (Eigen::Index k = 0; k < size; ++k) {
    window[k] = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(k) /
                                     static_cast<double>(size));
  }
  Eigen::FFT<double> fft;
  Eigen::VectorXcd transform;
  fft.fwd(transform, window);
  transform = transform.cwiseAbs2().cast<Complex>();
  Eigen::VectorXcd correlation;
  fft.inv(correlation, transform);
  return correlation.real().head(size) / correlation[0].real();
}

// Returns a column for each unknown of a channel (real and imaginary part of
// each a_m, then the noise) and a row for each line.
Matrix DensitiesOfUnknowns(const std::vector<IdentifiedMode>& modes,
                           double step, Eigen::Index size) {
  const Vector window = WindowCorrelation(size);
  const Eigen::Index half = size / 2;
  Matrix densities(half, 2 * static_cast<Eigen::Index>(modes.size()) + 1);
  densities.rightCols(1).setConstant(2.0 * step);
  Eigen::FFT<double> fft;
  Eigen::VectorXcd decay(size);
  Eigen::VectorXcd transform;
  for (size_t m = 0; m < modes.size(); ++m) {
    const double w = kTwoPi * modes[m].frequency_hz;
    const double zeta = std::clamp(modes[m].damping_ratio, 1e-6, 0.999);
    const Complex pole(-zeta * w, w * std::sqrt(1.0 - zeta * zeta));
    for (int part = 0; part < 2; ++part) {
      const Complex a = part == 0 ? Complex(1.0, 0.0) : Complex(0.0, 1.0);
      for (Eigen::Index k = 0; k < size; ++k) {
        const double value =
            (a * std::exp(pole * (step * static_cast<double>(k)))).real();
        decay[k] = value * window[k];
      }
      fft.fwd(transform, decay);
      densities.col(2 * static_cast<Eigen::Index>(m) + part) =
          2.0 * step *
          (2.0 * transform.segment(1, half).real().array() - decay[0].real());
    }
  }
  return densities;
}

// Returns means of neighbouring lines.
Vector Smooth(const Vector& values) {
  Vector means(values.size());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const Eigen::Index first = std::max<Eigen::Index>(0, k - kNeighbours);
    const Eigen::Index last =
        std::min<Eigen::Index>(values.size() - 1, k + kNeighbours);
    means[k] = values.segment(first, last - first + 1).mean();
  }
  return means;
}

// Solves weighted least squares for one channel. The last unknown is not
// negative.
Vector FitChannel(const Matrix& densities, const Vector& measured) {
  const Vector smooth = Smooth(measured);
  const Eigen::Index unknowns = densities.cols();
  Vector model = smooth;
  Vector solution = Vector::Zero(unknowns);
  for (int i = 0; i < kReweightings; ++i) {
    const Vector weights = model.cwiseMax(kLeastShare * smooth)
                               .cwiseMax(1e-300)
                               .cwiseSqrt()
                               .cwiseInverse();
    Matrix rows = weights.asDiagonal() * densities;
    const Vector scale =
        rows.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
    rows = rows * scale.asDiagonal();
    const Vector right = weights.cwiseProduct(measured);
    solution = scale.cwiseProduct(rows.colPivHouseholderQr().solve(right));
    if (solution[unknowns - 1] < 0.0) {
      const Eigen::Index rest = unknowns - 1;
      solution << scale.head(rest).cwiseProduct(
          Matrix(rows.leftCols(rest)).colPivHouseholderQr().solve(right)),
          0.0;
    }
    model = densities * solution;
  }
  return solution;
}

}  // namespace

ModalSpectra FitModalSpectra(const ResponseRecord& record,
                             const std::vector<IdentifiedMode>& modes,
                             double lowest_hz, double highest_hz) {
  const Spectra spectra = EstimateSpectra(record, 0, 0);
  const Eigen::Index half = spectra.frequency_hz.size();
  const Matrix all = DensitiesOfUnknowns(modes, record.sampling_step, 2 * half);
  Eigen::Index first = 0;
  while (first < half && spectra.frequency_hz[first] < lowest_hz) ++first;
  Eigen::Index count = 0;
  while (first + count < half &&
         spectra.frequency_hz[first + count] <= highest_hz) {
    ++count;
  }
  ModalSpectra result;
  result.num_segments = spectra.num_segments;
  result.frequency_hz = spectra.frequency_hz.segment(first, count);
  result.measured = spectra.densities.middleCols(first, count);
  result.modelled = Matrix::Zero(result.measured.rows(), count);
  result.explained = Vector::Zero(result.measured.rows());
  const Matrix densities = all.middleRows(first, count);
  // Fewer lines than unknowns explain nothing.
  if (count < 2 * densities.cols()) return result;
  for (Eigen::Index c = 0; c < result.measured.rows(); ++c) {
    const Vector measured = result.measured.row(c).transpose();
    const Vector solution = FitChannel(densities, measured);
    const Vector model = densities * solution;
    result.modelled.row(c) = model.transpose();
    const double noise = densities.rightCols(1).sum() * solution.tail(1)[0];
    const double power = measured.sum();
    // A channel without power has nothing to explain.
    if (power > 0.0) result.explained[c] = (model.sum() - noise) / power;
  }
  return result;
}

ModalSpectra FitModalSpectra(const ResponseRecord& record,
                             const ModesOfRecord& modes) {
  if (modes.method == ModalMethod::kRingDown || modes.bands.empty()) return {};
  double lowest = kInfinity;
  double highest = 0.0;
  for (const AnalysedBand& band : modes.bands) {
    lowest = std::min(lowest, band.lowest_hz);
    highest = std::max(highest, band.highest_hz);
  }
  return FitModalSpectra(record, modes.modes, lowest, highest);
}

}  // namespace pinode
