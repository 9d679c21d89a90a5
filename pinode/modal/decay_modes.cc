#include "pinode/modal/decay_modes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/smooth_number.h"
#include "pinode/modal/decay_fit.h"
#include "pinode/modal/ring_down.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Most samples in which terms are looked for.
constexpr Eigen::Index kMostFitted = 4000;
// Relative standard deviation of the sampling step, which is computed from a
// column of times in double precision. (In decays with noise of 1e-12
// frequencies are off by 0.6e-13 to 5.8e-13.)
constexpr double kClock = 5e-13;
// Parts of the spectrum whose levels are compared, the deviations by which they
// may differ, and the smallest fraction of noise that counts as left.
constexpr Eigen::Index kParts = 8;
constexpr double kMostScatter = 5.0;
constexpr double kLeastFraction = 0.1;
// Relative difference in frequency of a picked vibration and its term.
constexpr double kPickTolerance = 0.01;

// Sets the scatter of the members around the mean, with weights as in a mean of
// a cluster.
void SetSpread(const std::vector<SubspacePole>& poles, PoleCluster* cluster) {
  double weights = 0.0;
  double frequencies = 0.0;
  double ratios = 0.0;
  for (const int member : cluster->members) {
    const SubspacePole& pole = poles[static_cast<size_t>(member)];
    const double sigma = FindPoleSigmas(pole, 0.0).frequency;
    const double weight = 1.0 / std::max(sigma * sigma, 1e-300);
    weights += weight;
    frequencies +=
        weight * std::pow(pole.frequency() - cluster->mean.frequency(), 2);
    ratios += weight *
              std::pow(pole.damping_ratio() - cluster->mean.damping_ratio(), 2);
  }
  if (!(weights > 0.0)) return;
  cluster->frequency_spread = std::sqrt(frequencies / weights);
  cluster->damping_spread = std::sqrt(ratios / weights);
}

// Returns the expected fraction of white noise that a fit leaves at each
// frequency: each channel has lost its amplitudes, and all of them together the
// unknowns of the poles, which are as many.
Vector FractionsLeft(const DecayFit& fit, Eigen::Index channels) {
  const Eigen::Index samples = fit.q.rows();
  Eigen::FFT<double> fft;
  Eigen::VectorXcd transform;
  Vector removed = Vector::Zero(samples / 2 + 1);
  for (Eigen::Index i = 0; i < fit.q.cols(); ++i) {
    const Vector column = fit.q.col(i);
    fft.fwd(transform, column);
    removed += transform.head(removed.size()).cwiseAbs2();
  }
  removed *= (1.0 + 1.0 / static_cast<double>(channels)) /
             static_cast<double>(samples);
  return 1.0 - removed.array();
}

// Returns true if the power of the residuals is the same in all parts of the
// spectrum, up to its own scatter.
bool IsWhite(const DecayFit& fit, const Vector& fractions) {
  const Eigen::Index samples = fit.residuals.rows();
  Eigen::FFT<double> fft;
  Eigen::VectorXcd transform;
  Vector power = Vector::Zero(fractions.size());
  for (Eigen::Index c = 0; c < fit.residuals.cols(); ++c) {
    const Vector column = fit.residuals.col(c);
    fft.fwd(transform, column);
    power += transform.head(power.size()).cwiseAbs2();
  }
  const Eigen::Index size = power.size() / kParts;
  if (size < 4 || samples < 8 * fit.basis.cols()) return false;
  double smallest = kInfinity;
  double largest = 0.0;
  for (Eigen::Index i = 0; i < kParts; ++i) {
    const double level =
        power.segment(i * size, size).sum() /
        fractions.segment(i * size, size).cwiseMax(kLeastFraction).sum();
    smallest = std::min(smallest, level);
    largest = std::max(largest, level);
  }
  // Standard deviation of the logarithm of a part's level.
  const double scatter =
      1.0 / std::sqrt(static_cast<double>(size * fit.residuals.cols()));
  return largest < smallest * std::exp(kMostScatter * scatter);
}

// Series of noise with the spectra of the residuals and their size over time.
std::function<Matrix(int)> NoiseOf(const DecayFit& fit, const DecayModel& model,
                                   const Vector& fractions) {
  // Residuals of a constant size over time.
  const Vector envelope = model.row_weights().cwiseInverse();
  const auto series = MakeNoiseSeries(
      DecayResiduals(fit, model) * model.row_weights().asDiagonal(), fractions);
  return [series, envelope](int b) {
    return Matrix(series(b) * envelope.asDiagonal());
  };
}

// Increases influences to the Cramer-Rao bound. Below it they are by the
// scatter of the noise near a frequency, and of the series.
void RespectBounds(DecayModel::Influences* influences) {
  for (size_t i = 0; i < influences->bounds.size(); ++i) {
    auto own = influences->s.row(static_cast<Eigen::Index>(i));
    const double count = static_cast<double>(own.size());
    const Eigen::Matrix2d& bound = influences->bounds[i];
    const double real = own.real().squaredNorm() / count;
    const double imaginary = own.imag().squaredNorm() / count;
    double factor = 1.0;
    if (real > 0.0) factor = std::max(factor, bound(0, 0) / real);
    if (imaginary > 0.0) factor = std::max(factor, bound(1, 1) / imaginary);
    own *= std::sqrt(factor);
    influences->shapes[i] *= std::sqrt(factor);
  }
}

// Returns the indices of the terms that are the picked vibrations. Adds those
// that are none.
std::vector<size_t> Pick(const std::vector<Complex>& picked,
                         const DecayModel& model, DecayFit* fit) {
  std::vector<size_t> indices;
  for (const Complex& wanted : picked) {
    size_t best = fit->terms.size();
    double smallest = kPickTolerance * std::abs(wanted);
    for (size_t i = 0; i < fit->terms.size(); ++i) {
      if (!fit->terms[i].vibrates() || fit->terms[i].is_alias) continue;
      const double apart =
          std::abs(std::abs(fit->terms[i].s) - std::abs(wanted));
      if (apart <= smallest) {
        smallest = apart;
        best = i;
      }
    }
    if (best == fit->terms.size()) {
      std::vector<DecayTerm> terms = fit->terms;
      terms.push_back({wanted});
      *fit = model.Solve(terms);
    }
    if (std::find(indices.begin(), indices.end(), best) == indices.end()) {
      indices.push_back(best);
    }
  }
  return indices;
}

// Returns the vibration of a term, with one as its largest entry.
PoleCluster ClusterOf(const DecayFit& fit, size_t term, const DecayModel& model,
                      const DecayModel::Influences& influences) {
  PoleCluster cluster;
  SubspacePole& mean = cluster.mean;
  mean.s = fit.terms[term].s;
  mean.shape =
      fit.Shape(term).cwiseQuotient(model.channel_weights().cast<Complex>());
  mean.s_influence = ComplexVector::Zero(kNoiseSeries + 1);
  mean.s_influence.head(kNoiseSeries) =
      influences.s.row(static_cast<Eigen::Index>(term)).transpose();
  mean.s_influence[kNoiseSeries] =
      kClock * std::sqrt(static_cast<double>(kNoiseSeries + 1)) * mean.s;
  mean.shape_influence =
      ComplexMatrix::Zero(mean.shape.size(), kNoiseSeries + 1);
  mean.shape_influence.leftCols(kNoiseSeries) = influences.shapes[term];
  mean.shape.cwiseAbs().maxCoeff(&cluster.reference);
  mean = NormalisedPole(mean, cluster.reference);
  const PoleSigmas sigmas = FindPoleSigmas(mean, 0.0);
  cluster.frequency_sigma = sigmas.frequency;
  cluster.damping_sigma = sigmas.damping;
  return cluster;
}

}  // namespace

std::vector<DecayTerm> FindDecayTerms(const Matrix& samples, double step,
                                      const std::vector<SubspacePole>& poles,
                                      const std::vector<DecayTerm>& known) {
  DecayModel model(samples.leftCols(std::min(
                       kMostFitted, UsedSamples(samples, samples.cols() / 4))),
                   step);
  std::vector<Complex> candidates;
  for (const SubspacePole& pole : poles) candidates.push_back(pole.s);
  return FindDecays(known, candidates, &model).terms;
}

DecayModes EstimateDecays(const Matrix& samples, double step,
                          const std::vector<DecayTerm>& known,
                          const std::vector<std::complex<double>>& candidates,
                          const std::vector<std::complex<double>>& picked) {
  const Eigen::Index used =
      SmoothNumberBelow(UsedSamples(samples, samples.cols() / 4));
  DecayModel model(samples.leftCols(used), step);
  DecayFit fit = FindDecays(known, candidates, &model);
  std::vector<size_t> wanted = Pick(picked, model, &fit);
  if (picked.empty()) {
    for (size_t i = 0; i < fit.terms.size(); ++i) {
      if (fit.terms[i].vibrates() && !fit.terms[i].is_alias) {
        wanted.push_back(i);
      }
    }
  }
  DecayModes modes;
  modes.rest = DecayResiduals(fit, model).rowwise().norm().array() /
               samples.leftCols(used).rowwise().norm().array().max(1e-300);
  if (wanted.empty()) return modes;
  const Vector fractions = FractionsLeft(fit, model.num_channels());
  DecayModel::Influences influences =
      model.FindInfluences(fit, kNoiseSeries, NoiseOf(fit, model, fractions));
  if (IsWhite(fit, fractions)) RespectBounds(&influences);
  for (const size_t i : wanted) {
    modes.clusters.push_back(ClusterOf(fit, i, model, influences));
  }
  std::sort(modes.clusters.begin(), modes.clusters.end(),
            [](const PoleCluster& a, const PoleCluster& b) {
              return a.mean.frequency() < b.mean.frequency();
            });
  return modes;
}

void FindDecayMembers(const std::vector<SubspacePole>& poles,
                      const StabilisationOptions& options,
                      PoleCluster* cluster) {
  const SubspacePole& mean = cluster->mean;
  std::map<int, std::pair<double, int>> nearest;  // by order
  for (size_t i = 0; i < poles.size(); ++i) {
    if (std::abs(poles[i].frequency() / mean.frequency() - 1.0) >
            options.frequency_tolerance ||
        std::abs(poles[i].damping_ratio() - mean.damping_ratio()) >
            options.frequency_tolerance + mean.damping_ratio() ||
        ComplexMac(poles[i].shape, mean.shape) < options.smallest_mac) {
      continue;
    }
    const double apart = std::abs(poles[i].s - mean.s);
    const auto [place, added] =
        nearest.insert({poles[i].order, {apart, static_cast<int>(i)}});
    if (!added && apart < place->second.first) {
      place->second = {apart, static_cast<int>(i)};
    }
  }
  cluster->members.clear();
  for (const auto& [order, found] : nearest) {
    cluster->members.push_back(found.second);
  }
  cluster->chosen = cluster->members;
  if (!cluster->members.empty()) {
    cluster->first_order =
        poles[static_cast<size_t>(cluster->members.front())].order;
  }
  SetSpread(poles, cluster);
}

std::vector<DecayTerm> TermsAtHalfRate(const std::vector<DecayTerm>& terms,
                                       double step) {
  const double half = kPi / (2.0 * step);  // half of the lower rate
  std::vector<DecayTerm> images = terms;
  for (DecayTerm& term : images) {
    if (term.s.imag() <= half) continue;
    term.s = {term.s.real(), 2.0 * half - term.s.imag()};
    term.is_alias = true;
  }
  return images;
}

}  // namespace pinode
