#include "pinode/modal/ring_down.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numeric>
#include <random>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/smooth_number.h"
#include "pinode/base/statistics.h"

namespace pinode {
namespace {

// Most columns of the matrix, and number of stretches for the decay's energy.
constexpr Eigen::Index kMostColumns = 800;
constexpr Eigen::Index kStretches = 40;
// Share of the frequencies on either side from which noise is taken.
constexpr Eigen::Index kNeighbourhood = 40;
// Probability that noise looks like a decay somewhere in the record.
constexpr double kFalseDecay = 1e-3;

// Returns the number of samples up to the last stretch with at least twice the
// energy of the quietest one.
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
  const Matrix left = data - basis * qr.solve(data);
  // The fitted amplitudes and eigenvalues have removed some of the noise.
  const double taken = static_cast<double>(qr.rank()) *
                       (1.0 + 1.0 / static_cast<double>(samples.rows()));
  const double degrees = std::max(1.0, static_cast<double>(count) - taken);
  return left.transpose() * std::sqrt(static_cast<double>(count) / degrees);
}

// Generates series with the spectra and cross spectra of `residuals`.
class NoiseSeries {
 public:
  explicit NoiseSeries(const Matrix& residuals)
      : channels_(residuals.rows()), samples_(residuals.cols()) {
    Eigen::FFT<double> fft;
    Eigen::VectorXcd transform;
    transforms_.resize(samples_, channels_);
    for (Eigen::Index c = 0; c < channels_; ++c) {
      const Vector values = residuals.row(c);
      fft.fwd(transform, values);
      transforms_.col(c) = transform;
    }
  }

  Matrix Make(unsigned seed) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    // Above zero and below half the sampling rate.
    const Eigen::Index last = (samples_ - 1) / 2;
    const Eigen::Index reach = std::max<Eigen::Index>(1, last / kNeighbourhood);
    std::uniform_int_distribution<Eigen::Index> apart(-reach, reach);
    Eigen::MatrixXcd turned = Eigen::MatrixXcd::Zero(samples_, channels_);
    for (Eigen::Index f = 1; f <= last; ++f) {
      const Eigen::Index from =
          std::clamp<Eigen::Index>(f + apart(random), 1, last);
      const std::complex<double> turn =
          std::complex<double>(normal(random), normal(random)) / std::sqrt(2.0);
      turned.row(f) = turn * transforms_.row(from);
      turned.row(samples_ - f) = turned.row(f).conjugate();
    }
    if (samples_ % 2 == 0) {
      turned.row(samples_ / 2) = normal(random) * transforms_.row(samples_ / 2);
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
  const Eigen::Index channels_;
  const Eigen::Index samples_;
  Eigen::MatrixXcd transforms_;  // samples x channels
};

}  // namespace

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
  const auto noise = std::make_shared<const NoiseSeries>(residuals);
  result.noise_series = [noise](int b) {
    return noise->Make(static_cast<unsigned>(b) + 1u);
  };
  hankel.num_windows = kNoiseSeries;
  hankel.change = [series = result.noise_series, block_rows, columns](int b) {
    return HankelOf(series(b), block_rows, columns);
  };
  return result;
}

std::vector<bool> FindSignificantDecays(
    const RingDown& ring_down, const std::vector<std::complex<double>>& s,
    double step) {
  std::vector<size_t> kept(s.size());
  std::iota(kept.begin(), kept.end(), size_t{0});
  const Vector weights = ring_down.noise.cwiseMax(1e-12).cwiseInverse();
  const Matrix data = ring_down.samples.transpose() * weights.asDiagonal();
  const double trials = 2.0 * static_cast<double>(data.rows());
  // Real and imaginary parts at all channels, frequency and damping.
  const double degrees = 2.0 * static_cast<double>(data.cols()) + 2.0;
  while (!kept.empty()) {
    std::vector<std::complex<double>> lambdas;
    for (const size_t i : kept) lambdas.push_back(std::exp(s[i] * step));
    const Matrix basis = DecayBasis(lambdas, data.rows());
    Matrix products = basis.transpose() * basis;
    products.diagonal() *= 1.0 + 1e-12;
    const Matrix inverse = products.ldlt().solve(
        Matrix::Identity(products.rows(), products.cols()));
    const Matrix amplitudes = inverse * (basis.transpose() * data);
    size_t least = 0;
    double smallest = kInfinity;
    for (size_t i = 0; i < kept.size(); ++i) {
      const Eigen::Index row = 2 * static_cast<Eigen::Index>(i);
      const Matrix pair = amplitudes.middleRows(row, 2);
      const Eigen::Matrix2d scatter = inverse.block<2, 2>(row, row);
      const double explained =
          pair.cwiseProduct(Matrix(scatter.inverse() * pair)).sum();
      if (explained < smallest) {
        smallest = explained;
        least = i;
      }
    }
    if (trials * ChiSquareProbability(smallest, degrees) < kFalseDecay) break;
    kept.erase(kept.begin() + static_cast<long>(least));
  }
  std::vector<bool> significant(s.size(), false);
  for (const size_t i : kept) significant[i] = true;
  return significant;
}

void FitDecayShapes(const RingDown& ring_down, double step,
                    std::vector<PoleCluster>* clusters) {
  if (clusters->empty()) return;
  const Eigen::Index count = static_cast<Eigen::Index>(clusters->size());
  const Eigen::Index samples = ring_down.samples.cols();
  std::vector<std::complex<double>> lambdas;
  for (const PoleCluster& cluster : *clusters) {
    lambdas.push_back(std::exp(cluster.mean.s * step));
  }
  Matrix basis(samples, 2 * count + 1);
  basis << DecayBasis(lambdas, samples), Vector::Ones(samples);
  const Eigen::ColPivHouseholderQR<Matrix> qr(basis);
  // Returns the amplitudes, channels x modes; a mode is Re a lambda^k.
  const auto amplitudes = [&](const Matrix& data) {
    const Matrix parts = qr.solve(data.transpose());
    ComplexMatrix a(data.rows(), count);
    for (Eigen::Index m = 0; m < count; ++m) {
      a.col(m).real() = parts.row(2 * m).transpose();
      a.col(m).imag() = -parts.row(2 * m + 1).transpose();
    }
    return a;
  };
  const ComplexMatrix shapes = amplitudes(ring_down.samples);
  // A change ds of s moves lambda^k by ds times the time times itself.
  const Vector times =
      step * Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  const Eigen::Index series = (*clusters)[0].mean.s_influence.size();
  std::vector<ComplexMatrix> influences(static_cast<size_t>(count),
                                        ComplexMatrix(shapes.rows(), series));
  for (Eigen::Index b = 0; b < series; ++b) {
    Matrix data = ring_down.noise_series(static_cast<int>(b));
    for (Eigen::Index m = 0; m < count; ++m) {
      const std::complex<double> ds =
          (*clusters)[static_cast<size_t>(m)].mean.s_influence[b];
      const ComplexVector moved = ds * shapes.col(m);
      data.noalias() -= (moved.real() * basis.col(2 * m).transpose() -
                         moved.imag() * basis.col(2 * m + 1).transpose()) *
                        times.asDiagonal();
    }
    const ComplexMatrix change = amplitudes(data);
    for (Eigen::Index m = 0; m < count; ++m) {
      influences[static_cast<size_t>(m)].col(b) = change.col(m);
    }
  }
  for (Eigen::Index m = 0; m < count; ++m) {
    PoleCluster& cluster = (*clusters)[static_cast<size_t>(m)];
    cluster.mean.shape = shapes.col(m);
    cluster.mean.shape_influence =
        std::move(influences[static_cast<size_t>(m)]);
    cluster.mean.shape.cwiseAbs().maxCoeff(&cluster.reference);
    cluster.mean = NormalisedPole(cluster.mean, cluster.reference);
  }
}

}  // namespace pinode
