#include "pinode/modal/ring_down.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <random>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "pinode/base/smooth_number.h"

namespace pinode {
namespace {

// Most columns of the matrix, and number of stretches for the decay's energy.
constexpr Eigen::Index kMostColumns = 800;
constexpr Eigen::Index kStretches = 40;
// Share of the frequencies on either side from which noise is taken.
constexpr Eigen::Index kNeighbourhood = 40;
// Smallest fraction of the noise that is taken to be left of it.
constexpr double kSmallestFraction = 0.1;

Matrix HankelOf(const Matrix& samples, int block_rows, Eigen::Index columns) {
  const Eigen::Index channels = samples.rows();
  Matrix h(block_rows * channels, columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    h.col(j) =
        samples.middleCols(j, block_rows).reshaped(block_rows * channels, 1);
  }
  return h;
}

// Returns columns Re and Im of lambda^k, one pair after the other.
Matrix DecayBasis(const std::vector<std::complex<double>>& lambdas,
                  Eigen::Index samples) {
  Matrix basis(samples, 2 * static_cast<Eigen::Index>(lambdas.size()));
  for (size_t i = 0; i < lambdas.size(); ++i) {
    const Eigen::Index column = 2 * static_cast<Eigen::Index>(i);
    std::complex<double> power = 1.0;
    for (Eigen::Index k = 0; k < samples; ++k) {
      basis(k, column) = power.real();
      basis(k, column + 1) = power.imag();
      power *= lambdas[i];
      if (std::abs(power) < 1e-200) power = 0.0;
    }
  }
  return basis;
}

// Returns the residuals of the samples after a fit of vibrations lambda^k that
// do not grow.
Matrix Residuals(const Matrix& samples, const Eigen::VectorXcd& eigenvalues) {
  std::vector<std::complex<double>> kept;
  for (const std::complex<double>& lambda : eigenvalues) {
    if (lambda.imag() >= 0.0 && std::abs(lambda) < 1.0) kept.push_back(lambda);
  }
  const Eigen::Index count = samples.cols();
  const Matrix basis = DecayBasis(kept, count);
  const Eigen::ColPivHouseholderQR<Matrix> qr(basis);
  const Matrix data = samples.transpose();
  const Matrix amplitudes = qr.solve(data);
  const Matrix left = data - basis * amplitudes;
  // The fitted amplitudes and eigenvalues have removed some of the noise.
  const double taken = static_cast<double>(qr.rank()) *
                       (1.0 + 1.0 / static_cast<double>(samples.rows()));
  const double degrees = std::max(1.0, static_cast<double>(count) - taken);
  return left.transpose() * std::sqrt(static_cast<double>(count) / degrees);
}

// Generates series with the spectra and cross spectra of `residuals`.
class NoiseSeries {
 public:
  // fractions: see MakeNoiseSeries.
  NoiseSeries(const Matrix& residuals, const Vector& fractions)
      : channels_(residuals.rows()),
        samples_(residuals.cols()),
        gains_(Vector::Ones(samples_ / 2 + 1)) {
    Eigen::FFT<double> fft;
    Eigen::VectorXcd transform;
    transforms_.resize(samples_, channels_);
    for (Eigen::Index c = 0; c < channels_; ++c) {
      const Vector values = residuals.row(c);
      fft.fwd(transform, values);
      transforms_.col(c) = transform;
    }
    if (fractions.size() == 0) return;
    const Eigen::Index reach = Reach();
    for (Eigen::Index f = 0; f < gains_.size(); ++f) {
      const Eigen::Index first = std::max<Eigen::Index>(0, f - reach);
      const Eigen::Index last = std::min(gains_.size() - 1, f + reach);
      const double mean = fractions.segment(first, last - first + 1).mean();
      gains_[f] = 1.0 / std::sqrt(std::max(mean, kSmallestFraction));
    }
  }

  Matrix Make(unsigned seed) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    // Above zero and below half the sampling rate.
    const Eigen::Index last = (samples_ - 1) / 2;
    const Eigen::Index reach = Reach();
    std::uniform_int_distribution<Eigen::Index> apart(-reach, reach);
    Eigen::MatrixXcd turned = Eigen::MatrixXcd::Zero(samples_, channels_);
    for (Eigen::Index f = 1; f <= last; ++f) {
      const Eigen::Index from =
          std::clamp<Eigen::Index>(f + apart(random), 1, last);
      const std::complex<double> turn =
          std::complex<double>(normal(random), normal(random)) / std::sqrt(2.0);
      turned.row(f) = gains_[f] * turn * transforms_.row(from);
      turned.row(samples_ - f) = turned.row(f).conjugate();
    }
    if (samples_ % 2 == 0) {
      turned.row(samples_ / 2) =
          gains_[samples_ / 2] * normal(random) * transforms_.row(samples_ / 2);
    }
    Eigen::FFT<double> fft;
    Matrix series(channels_, samples_);
    Eigen::VectorXcd back;
    for (Eigen::Index c = 0; c < channels_; ++c) {
      const Eigen::VectorXcd column = turned.col(c);
      fft.inv(back, column);
      series.row(c) = back.real().transpose();
    }
    return series;
  }

 private:
  // Frequencies on either side from which noise is taken.
  Eigen::Index Reach() const {
    return std::max<Eigen::Index>(1, (samples_ - 1) / 2 / kNeighbourhood);
  }

  const Eigen::Index channels_;
  const Eigen::Index samples_;
  Vector gains_;
  Eigen::MatrixXcd transforms_;  // samples x channels
};

}  // namespace

Eigen::Index UsedSamples(const Matrix& samples, Eigen::Index fewest) {
  const Eigen::Index size = samples.cols() / kStretches;
  if (size < 4) return samples.cols();
  Vector energy(kStretches);
  for (Eigen::Index i = 0; i < kStretches; ++i) {
    energy[i] = samples.middleCols(i * size, size).squaredNorm();
  }
  const double floor = energy.minCoeff();
  Eigen::Index last = kStretches;
  while (last > 1 && energy[last - 1] < 2.0 * floor) --last;
  return last == kStretches
             ? samples.cols()
             : std::min(samples.cols(), std::max(fewest, last * size));
}

RingDown RingDownHankel(const Matrix& samples, int block_rows, int order) {
  RingDown result;
  const Eigen::Index used = SmoothNumberBelow(std::min(
      kMostColumns + block_rows - 1, UsedSamples(samples, 3 * block_rows)));
  result.samples = samples.leftCols(used);
  const Eigen::Index columns = used + 1 - block_rows;
  HankelWindows& hankel = result.hankel;
  hankel.num_channels = static_cast<int>(samples.rows());
  hankel.mean = HankelOf(result.samples, block_rows, columns);
  const Matrix residuals =
      Residuals(result.samples, FindEigenvalues(hankel, order));
  result.noise =
      residuals.rowwise().norm() / std::sqrt(static_cast<double>(used));
  result.noise_series = MakeNoiseSeries(residuals, Vector());
  hankel.num_windows = kNoiseSeries;
  hankel.change = [series = result.noise_series, block_rows, columns](int b) {
    return HankelOf(series(b), block_rows, columns);
  };
  return result;
}

std::function<Matrix(int)> MakeNoiseSeries(const Matrix& residuals,
                                           const Vector& fractions) {
  const auto noise = std::make_shared<const NoiseSeries>(residuals, fractions);
  return [noise](int b) { return noise->Make(static_cast<unsigned>(b) + 1u); };
}

}  // namespace pinode
