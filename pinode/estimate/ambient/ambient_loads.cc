#include "pinode/estimate/ambient/ambient_loads.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "pinode/problem/load_information.h"

namespace pinode {
namespace {

// The least of the intensities that the prior holds covariances to, relative to
// that at the next knot and to the mean of all.
constexpr double kLeastOfNeighbour = 0.1;
constexpr double kLeastOfMean = 1e-3;

}  // namespace

AmbientLoads::AmbientLoads(const LoadSpectrum& spectrum,
                           const Vector& smallest_noise)
    : spectrum_(spectrum), smallest_noise_(smallest_noise) {}

void AmbientLoads::SetIntensities(const Matrix& intensities,
                                  const Vector& half_logarithms) {
  unknowns_.resize(spectrum_.num_unknowns() + half_logarithms.size());
  unknowns_ << spectrum_.Intensities(intensities), half_logarithms;
}

Vector AmbientLoads::Noise() const {
  return (2.0 * unknowns_.tail(num_channels())).array().exp();
}

std::vector<Matrix> AmbientLoads::KnotCovariances() const {
  std::vector<Matrix> covariances;
  for (int b = 0; b < spectrum_.num_knots(); ++b) {
    const Matrix root = spectrum_.Root(unknowns_, b);
    covariances.push_back(root * root.transpose());
  }
  return covariances;
}

Matrix AmbientLoads::Covariance(double frequency,
                                const std::vector<Matrix>& at_knots) const {
  double below = 0.0;
  double above = 0.0;
  const size_t knot =
      static_cast<size_t>(spectrum_.Weigh(frequency, &below, &above));
  Matrix covariance = below * at_knots[knot];
  if (above > 0.0) covariance += above * at_knots[knot + 1];
  return covariance;
}

Vector AmbientLoads::Moved(const Vector& unknowns, const Vector& step) const {
  constexpr double kMostFall = 0.1;  // of a variance
  const Eigen::Index noise = num_channels();
  const Eigen::Index loads = unknowns.size() - noise;
  Vector moved(unknowns.size());
  moved << spectrum_.Moved(unknowns.head(loads), step.head(loads)),
      (unknowns.tail(noise).array() +
       0.5 * (1.0 + 2.0 * step.tail(noise).array()).max(kMostFall).log())
          .max(0.5 * smallest_noise_.array().log());
  return moved;
}

double AmbientLoads::LargestFall(const Vector& unknowns,
                                 const Vector& step) const {
  return std::max(
      spectrum_.LargestFall(unknowns, step.head(spectrum_.num_unknowns())),
      -2.0 * step.tail(num_channels()).minCoeff());
}

void AmbientLoads::HoldNoise(LikelihoodSums* sums) const {
  const Eigen::Index loads = spectrum_.num_unknowns();
  const Vector smallest = 0.5 * smallest_noise_.array().log();
  for (Eigen::Index c = loads; c < unknowns_.size(); ++c) {
    if (unknowns_[c] > smallest[c - loads] || sums->gradient[c] < 0.0) continue;
    sums->gradient[c] = 0.0;
    sums->information.row(c).setZero();
    sums->information.col(c).setZero();
    sums->information(c, c) = 1.0;
    if (sums->products.size() == 0) continue;
    sums->products.row(c).setZero();
    sums->products.col(c).setZero();
  }
}

void AmbientLoads::AddPrior(double* cost, LikelihoodSums* sums) const {
  const Eigen::Index per_knot = spectrum_.per_knot();
  for (Eigen::Index b = 0; b < prior_.cols(); ++b) {
    const Matrix root = spectrum_.Root(unknowns_, static_cast<int>(b));
    const Matrix half = root.triangularView<Eigen::Lower>().solve(
        Matrix(prior_.col(b).cwiseSqrt().asDiagonal()));
    const Matrix inverse = root.triangularView<Eigen::Lower>().solve(
        Matrix::Identity(root.rows(), root.cols()));
    *cost += kPriorLines * (2.0 * root.diagonal().array().abs().log().sum() +
                            half.squaredNorm());
    if (sums == nullptr) continue;
    const Matrix precision = inverse.transpose() * inverse;
    const Matrix pull = precision * prior_.col(b).asDiagonal() * precision;
    sums->gradient.segment(b * per_knot, per_knot) +=
        ByLoadEntries(spectrum_, root, kPriorLines * (precision - pull));
    LoadInformation information(spectrum_);
    information.Add(precision.cast<std::complex<double>>(), kPriorLines, 1.0,
                    0.0);
    sums->information.block(b * per_knot, b * per_knot, per_knot, per_knot) +=
        information.Finish(root, root).topLeftCorner(per_knot, per_knot);
  }
}

LikelihoodSums AmbientLoads::PriorSums(double* cost) const {
  LikelihoodSums prior;
  prior.gradient = Vector::Zero(num_unknowns());
  prior.information = Matrix::Zero(num_unknowns(), num_unknowns());
  double of_prior = 0.0;
  AddPrior(&of_prior, &prior);
  if (cost != nullptr) *cost = of_prior;
  return prior;
}

Matrix AmbientLoads::MetricOfKnot(int knot) const {
  const Eigen::Index per_knot = spectrum_.per_knot();
  const Matrix root = spectrum_.Root(unknowns_, knot);
  const Matrix inverse = root.triangularView<Eigen::Lower>().solve(
      Matrix::Identity(root.rows(), root.cols()));
  LoadInformation information(spectrum_);
  information.Add((inverse.transpose() * inverse).cast<std::complex<double>>(),
                  1.0, 1.0, 0.0);
  return information.Finish(root, root).topLeftCorner(per_knot, per_knot);
}

Matrix AmbientLoads::RelativeMetric() const {
  const Eigen::Index per_knot = spectrum_.per_knot();
  Matrix metric = Matrix::Zero(num_unknowns(), num_unknowns());
  for (int b = 0; b < spectrum_.num_knots(); ++b) {
    metric.block(b * per_knot, b * per_knot, per_knot, per_knot) =
        MetricOfKnot(b);
  }
  metric.diagonal().tail(num_channels()).setConstant(kMetricOfNoise);
  return metric;
}

void AmbientLoads::MakeUncorrelated() {
  prior_.resize(0, 0);
  spectrum_ = spectrum_.Uncorrelated();
}

void AmbientLoads::MakeCorrelated(const LoadSpectrum& correlated) {
  const int knots = spectrum_.num_knots();
  Matrix intensities(spectrum_.num_areas(), knots);
  for (int b = 0; b < knots; ++b) {
    intensities.col(b) = spectrum_.Root(unknowns_, b).diagonal().cwiseAbs2();
  }
  prior_ = intensities;
  for (int b = 0; b < knots; ++b) {
    prior_.col(b) =
        prior_.col(b).cwiseMax(kLeastOfMean * intensities.col(b).mean());
    for (const int next : {b - 1, b + 1}) {
      if (next < 0 || next == knots) continue;
      prior_.col(b) =
          prior_.col(b).cwiseMax(kLeastOfNeighbour * intensities.col(next));
    }
  }
  const Vector noise = unknowns_.tail(num_channels());
  LoadSpectrum spectrum = correlated;
  spectrum.SetPowers(spectrum_);
  spectrum_ = spectrum;
  SetIntensities(prior_, noise);
}

AmbientLoads AmbientLoads::Refined() const {
  Vector loads;
  AmbientLoads finer(
      spectrum_.Refined(unknowns_.head(spectrum_.num_unknowns()), &loads),
      smallest_noise_);
  finer.unknowns_.resize(loads.size() + num_channels());
  finer.unknowns_ << loads, unknowns_.tail(num_channels());
  if (has_prior()) {
    Vector roots;
    spectrum_.Refined(spectrum_.Intensities(prior_), &roots);
    finer.prior_.resize(prior_.rows(), finer.spectrum_.num_knots());
    for (int b = 0; b < finer.spectrum_.num_knots(); ++b) {
      finer.prior_.col(b) =
          finer.spectrum_.Root(roots, b).diagonal().cwiseAbs2();
    }
  }
  return finer;
}

}  // namespace pinode
