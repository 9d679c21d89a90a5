#include "pinode/modal/spectra.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"

namespace pinode {
namespace {

// Limits of a segment in samples, and segments to average over.
constexpr Eigen::Index kSmallestSegment = 256;
constexpr Eigen::Index kLargestSegment = 8192;
constexpr Eigen::Index kSegmentsWanted = 32;

Eigen::Index SegmentSamples(Eigen::Index samples, Eigen::Index wanted) {
  if (wanted > 0) return std::min<Eigen::Index>(wanted, samples);
  Eigen::Index size = kSmallestSegment;
  while (2 * size <= std::min(kLargestSegment, samples / kSegmentsWanted)) {
    size *= 2;
  }
  return std::min(size, samples);
}

}  // namespace

Spectra EstimateSpectra(const ResponseRecord& record,
                        Eigen::Index segment_samples, int num_singular_values) {
  const Eigen::Index channels = record.num_channels();
  const Eigen::Index size =
      SegmentSamples(record.num_samples(), segment_samples);
  const Eigen::Index half = size / 2;
  Vector window(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    window[k] = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(k) /
                                     static_cast<double>(size));
  }
  Vector means(channels);
  Vector sigmas(channels);
  for (Eigen::Index c = 0; c < channels; ++c) {
    means[c] = MeanOfPresent(Vector(record.samples.row(c)));
    sigmas[c] = StandardDeviationOfPresent(record.samples.row(c));
  }
  // Sums by frequency, 1 to half.
  std::vector<Eigen::MatrixXcd> sums(
      static_cast<size_t>(half), Eigen::MatrixXcd::Zero(channels, channels));
  Spectra spectra;
  Eigen::FFT<double> fft;
  Eigen::MatrixXcd transforms(channels, half);
  Eigen::VectorXcd transform;
  for (Eigen::Index first = 0; first + size <= record.num_samples();
       first += std::max<Eigen::Index>(1, half)) {
    for (Eigen::Index c = 0; c < channels; ++c) {
      Vector values =
          record.samples.row(c).segment(first, size).transpose().array() -
          means[c];
      for (double& value : values) {
        if (std::isnan(value)) value = 0.0;
      }
      values.array() *= window.array();
      fft.fwd(transform, values);
      transforms.row(c) = transform.segment(1, half).transpose();
    }
    for (Eigen::Index f = 0; f < half; ++f) {
      sums[static_cast<size_t>(f)].noalias() +=
          transforms.col(f) * transforms.col(f).adjoint();
    }
    ++spectra.num_segments;
  }
  const double scale =
      2.0 * record.sampling_step / window.squaredNorm() /
      static_cast<double>(std::max<Eigen::Index>(1, spectra.num_segments));
  const Eigen::Index wanted =
      std::min<Eigen::Index>(num_singular_values, channels);
  spectra.frequency_hz.resize(half);
  spectra.densities.resize(channels, half);
  spectra.singular_values.resize(wanted, half);
  const Eigen::MatrixXcd weights = sigmas.cwiseInverse()
                                       .asDiagonal()
                                       .toDenseMatrix()
                                       .cast<std::complex<double>>();
  for (Eigen::Index f = 0; f < half; ++f) {
    const Eigen::MatrixXcd density = scale * sums[static_cast<size_t>(f)];
    spectra.frequency_hz[f] =
        static_cast<double>(f + 1) /
        (static_cast<double>(size) * record.sampling_step);
    spectra.densities.col(f) = density.diagonal().real();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> solver(
        Eigen::MatrixXcd(weights * density * weights), Eigen::EigenvaluesOnly);
    spectra.singular_values.col(f) =
        solver.eigenvalues().reverse().head(wanted);
  }
  return spectra;
}

}  // namespace pinode
